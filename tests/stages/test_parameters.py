"""Stage 2: what counts as known, and that nothing is designed with what is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.io import read_configuration
from lostmotion.stages.design import design
from lostmotion.stages.material import Material, Settings, from_configuration, from_rig
from lostmotion.stages.parameters import find_parameters


@pytest.fixture(scope="module")
def material() -> Material:
    return from_rig(1)[0]


@pytest.mark.usefixtures("short_search")
def test_swapped_sign_of_the_torque_designs_nothing(material: Material) -> None:
    """A recording that contradicts the model must not lead to a law made of start values."""
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.018, inertia_load=0.11, stiffness=6000.0, damping=0.4, backlash=0.012, coulomb=2.0
    )
    torque = lm.signals.excitation(1.2, 2e-4, seed=3, inertia=0.128, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(plant, torque_motor=torque, dt=2e-4)
    swapped = lm.Recording(run.time, {"torque_motor": -torque, "speed_motor": run["speed_motor"]})
    nameplate = {"inertia_motor": 0.02, "inertia_load": 0.11, "stiffness": 6000.0}
    found = find_parameters(replace(material, identify=swapped, nameplate=nameplate))
    assert found.drivetrain is None
    laws = design(material, found)
    assert laws.law is None
    assert "the recording contradicts the nameplate" in laws.skipped and "Check sign" in laws.skipped


def shaft_recording(speed_load: bool) -> lm.Recording:
    n = 4000
    time = np.arange(n) * 1e-3
    rng = np.random.default_rng(1)
    signals = {"speed_motor": 100.0 + rng.standard_normal(n), "torque_shaft": 5.0 + rng.standard_normal(n)}
    if speed_load:
        signals["speed_load"] = 100.0 + rng.standard_normal(n)
    return lm.Recording(time=time, signals=signals)


@pytest.mark.parametrize("speed_load", [False, True])
def test_without_motor_torque_nothing_is_invented(speed_load: bool) -> None:
    recording = shaft_recording(speed_load)
    found = find_parameters(
        Material(
            {"stiffness": 100.0}, Settings(), 1, False, recording, None, {"r": recording}, {"r": "identify"}
        )
    )
    assert found.skipped == "no torque_motor in the recording"
    assert found.drivetrain is None
    assert found.table["backlash"]["value"] is None
    assert found.table["stiffness"]["value"] == 100.0
    assert found.table["stiffness"]["source"] == "nameplate"
    assert "inertia_motor, inertia_load not known" in found.missing


def test_a_complete_nameplate_is_enough_for_a_design() -> None:
    recording = shaft_recording(False)
    nameplate = {
        "inertia_motor": 0.02, "inertia_load": 0.1, "stiffness": 6000.0, "damping": 0.4, "backlash": 0.01,
    }  # fmt: skip
    material = Material(
        nameplate, Settings(sample_time=1e-4), 1, False, recording, None, {"r": recording}, {"r": "identify"}
    )
    found = find_parameters(material)
    assert found.drivetrain is not None
    assert found.drivetrain.backlash == 0.01
    assert design(material, found).law is not None


def test_missing_start_values_are_named(material: Material) -> None:
    found = find_parameters(replace(material, nameplate={"stiffness": 6000.0}))
    assert found.skipped == "no start value for inertia_motor, inertia_load: add it to [nameplate]"


def test_a_recording_that_cannot_be_identified_skips_the_stage(material: Material) -> None:
    """A constant torque, or one second: the reason stands in the result, the run goes on."""
    assert material.identify is not None
    constant = material.identify.with_signals("measured", torque_motor=np.full(len(material.identify), 3.0))
    for recording in (constant, material.identify.window(0.0, 0.02)):
        found = find_parameters(replace(material, identify=recording))
        assert found.identification is None
        assert found.skipped
        assert found.table["inertia_motor"]["source"] == "nameplate"
        first = found.problems[0]  # beside "0 identified" stands no "0 problems"
        assert first.severity == "warning" and first.got in found.skipped


@pytest.mark.parametrize(("rows", "kept"), [(1200, 1200), (2500, 1750)])
def test_a_short_recording_is_not_cut_below_what_identifies(tmp_path: Path, rows: int, kept: int) -> None:
    time = 1e-3 * np.arange(rows)
    columns = np.column_stack([time, np.sin(20.0 * time), np.cos(20.0 * time)])
    header = "time,torque_motor,speed_motor"
    np.savetxt(tmp_path / "short.csv", columns, delimiter=",", header=header, comments="")
    (tmp_path / "rig.toml").write_text('[[recording]]\nfile = "short.csv"\n', encoding="utf-8")
    made = from_configuration(read_configuration(tmp_path / "rig.toml"))
    assert made.identify is not None and abs(len(made.identify) - kept) <= 1
    assert (made.validate is None) == (kept == rows)

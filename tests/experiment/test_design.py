"""Excitation designer: limits kept, intervals foretold, what will not be told is said."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.experiment.design import design_excitation
from lostmotion.experiment.rehearsal import HALVINGS, played, rehearsal_rigs
from lostmotion.rig.excitation import KINDS, Limits

NAMEPLATE = lm.Drivetrain.two_mass(
    inertia_motor=0.0196, inertia_load=0.1096, stiffness=6570.0, damping=0.39, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4, torque_limit=40.0,
)  # fmt: skip
WELL_KNOWN = ("inertia_motor", "inertia_load", "stiffness", "damping", "backlash")


@pytest.mark.usefixtures("fit_alone")
def test_predicted_intervals_come_true_on_a_rig() -> None:
    design = design_excitation(NAMEPLATE, speed_limit=45.0, plants=2)
    assert design.not_excited == ()
    recording, truth = lm.rig.record(1, torque_motor=design.recording["torque_motor"])
    found = lm.identify(recording, start=NAMEPLATE, second_estimator=False)
    for name in WELL_KNOWN:
        low, high = found.intervals[name]
        half = (high - low) / 2.0 / getattr(found.drivetrain, name)
        assert 1.0 / 1.5 < half / design.half_widths[name] < 1.5, name
        assert low < truth.parameters[name] < high


def test_with_a_fourth_inertia_predicted_and_found_intervals_are_narrow() -> None:
    """Below 1 %; how far below is up to which mode a further inertia might hide in, and differs from rig to rig."""
    design = design_excitation(NAMEPLATE, speed_limit=45.0, plants=2)
    recording, truth = lm.rig.record(1, torque_motor=design.recording["torque_motor"])
    found = lm.identify(recording, start=NAMEPLATE)
    for name in ("inertia_motor", "inertia_load", "stiffness", "backlash"):
        low, high = found.intervals[name]
        assert max(design.half_widths[name], (high - low) / 2.0 / truth.parameters[name]) < 0.01, name
        assert low < truth.parameters[name] < high


@pytest.mark.usefixtures("fit_alone")
@pytest.mark.parametrize("kind", [k for k in KINDS if k != "levels"])
def test_every_kind_keeps_its_limits(kind: str) -> None:
    limits = {"torque_limit": 25.0, "speed_limit": 12.0, "angle_limit": 1.5}
    design = design_excitation(NAMEPLATE, kind=kind, duration=1.0, dt=2e-4, plants=2, **limits)
    assert len(design.recording) == 5000
    for name, limit in limits.items():
        assert 0.0 < design.peaks[name.removesuffix("_limit")] <= limit
    # Where impacts add up the peaks jump with the scale, so that no limit needs to be reached: a hair more leaves one.
    more = (1.0 + 2.5 * 2.0**-HALVINGS / design.scale) * design.recording["torque_motor"]
    nameplate = NAMEPLATE.with_parameters(torque_limit=1e3)
    rigs = rehearsal_rigs(nameplate, {}, 2, 20, seed=1)
    assert played(more, rigs, Limits(*limits.values()), 2e-4) is None, "the largest amplitude"
    run = lm.simulate(NAMEPLATE, torque_motor=design.recording["torque_motor"], dt=2e-4)
    assert np.max(np.abs(run["speed_load"])) < 1.2 * limits["speed_limit"]


@pytest.mark.usefixtures("fit_alone")
def test_levels_within_an_angle() -> None:
    """In open loop the speed levels drift by what the friction is off: it must be known for an angle to be kept."""
    known = {"coulomb": (1.9, 2.1), "viscous": (0.0165, 0.0185)}
    design = design_excitation(
        NAMEPLATE, duration=4.0, dt=2e-4, speed_limit=30.0, angle_limit=4.0, plants=2, spread=known
    )
    assert design.peaks["angle"] <= 4.0
    assert design.scale < 1.0


@pytest.mark.usefixtures("fit_alone")
def test_what_will_not_be_told_is_said() -> None:
    """Torque far below the friction: nothing moves enough."""
    stuck = NAMEPLATE.with_parameters(coulomb=30.0)
    design = design_excitation(stuck, kind="multisine", duration=1.0, dt=2e-4, speed_limit=45.0, plants=2)
    assert "viscous" in design.not_excited
    (problem,) = [p for p in design.problems if p.where == "viscous"]
    assert "levels" in problem.remedy
    assert "viscous" not in design.intervals


@pytest.mark.usefixtures("fit_alone")
def test_fewer_bits_widen_the_intervals() -> None:
    """Those of one estimator: where the second replaces the fit, it may know some values better from fewer bits."""
    coarse, fine = (
        design_excitation(NAMEPLATE, duration=5.0, speed_limit=45.0, plants=2, encoder_bits=bits).half_widths
        for bits in (14, 20)
    )
    assert coarse["coulomb"] > 1.1 * fine["coulomb"]
    assert coarse["stiffness"] > 1.1 * fine["stiffness"]


@pytest.mark.usefixtures("fit_alone")
def test_saved_for_a_drive(tmp_path: Path) -> None:
    design = design_excitation(NAMEPLATE, duration=1.0, dt=2e-4, speed_limit=45.0, plants=2)
    design.save_csv(tmp_path / "test.csv")
    header, first, *rest = (tmp_path / "test.csv").read_text().splitlines()
    assert header == "time [s],torque_motor [Nm]" and first.startswith("0.0,")
    assert len(rest) == len(design.recording) - 1


def test_misuse_is_told() -> None:
    with pytest.raises(lm.InvalidInput, match="kind"):
        design_excitation(NAMEPLATE, kind="sweep", speed_limit=10.0)
    with pytest.raises(lm.InvalidInput, match="speed_limit"):
        design_excitation(NAMEPLATE, speed_limit=-1.0)
    with pytest.raises(lm.InvalidInput, match="torque_limit"):
        design_excitation(NAMEPLATE.with_parameters(torque_limit=np.inf), speed_limit=10.0)
    with pytest.raises(lm.InvalidInput, match="two masses"):
        design_excitation(lm.Drivetrain((0.1,)), speed_limit=10.0, torque_limit=1.0)
    with pytest.raises(lm.InvalidInput, match="plants"):
        design_excitation(NAMEPLATE, speed_limit=10.0, plants=1)
    for name, value in (
        ("dt", 0.0),
        ("dt", np.nan),
        ("duration", np.inf),
        ("encoder_bits", 5000),
        ("encoder_bits", -3),
    ):
        with pytest.raises(lm.InvalidInput, match=name):
            design_excitation(NAMEPLATE, speed_limit=10.0, torque_limit=10.0, **{name: value})


def test_a_drive_that_cannot_move_is_told_by_its_inertia() -> None:
    """An inertia in g cm², 1e7 times that in kg m²."""
    heavy = lm.Drivetrain.two_mass(inertia_motor=2e5, inertia_load=1e6, stiffness=6000.0, damping=0.4)
    with pytest.raises(lm.InvalidInput, match=r"1\.2e\+06 kg m² in all"):
        design_excitation(heavy, duration=0.2, torque_limit=5.0, speed_limit=50.0)

"""Tests of one thing from a TOML: each recording by what it is for, without Python."""

from __future__ import annotations

import inspect
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import identification
from lostmotion.cli.options import TESTS
from lostmotion.commands.identify import identify_file
from lostmotion.errors import InputProblems, InvalidInput
from lostmotion.identification.prediction_error.identify import FURTHER
from lostmotion.io import load_json, read_configuration
from lostmotion.io.configuration.methods import MEASURED, METHODS
from lostmotion.io.configuration.problems import find_problems
from lostmotion.stages.material import from_configuration
from lostmotion.stages.parameters import find_parameters
from lostmotion.stages.single_tests import single_tests

DT = 1e-3
TOML = """
[[recording]]
file = "step.csv"
use = "torque_step"
options = { inertia = "1292 kgcm2" }

[[recording]]
file = "swing.csv"
use = "ring_down"
options = { signal = "torque_shaft", band = [5, 100] }

[[recording]]
file = "swing.csv"
use = "breakaway"
"""


def save(path: Path, header: str, columns: np.ndarray) -> None:
    np.savetxt(path, columns, delimiter=",", header=header, comments="")


@pytest.fixture
def toml(tmp_path: Path) -> Path:
    """A torque step of one inertia, and a shaft that rings down."""
    random = np.random.default_rng(1)
    plant = lm.Drivetrain(inertias=(0.1292,), frictions=(lm.Friction(2.0, 0.0175),))
    torque = np.r_[np.full(6000, 12.0), np.zeros(4000)]
    step = lm.simulate(plant, torque_motor=torque, dt=DT)
    noisy = step["speed_motor"] + 0.05 * random.standard_normal(torque.size)
    columns = np.column_stack([step.time, torque + 0.05 * random.standard_normal(torque.size), noisy])
    np.savetxt(
        tmp_path / "step.csv", columns, delimiter=",", header="time,torque_motor,speed_motor", comments=""
    )
    time = DT * np.arange(2000)
    swing = np.exp(-4.0 * time) * np.cos(2.0 * np.pi * 20.0 * time) + 0.01 * random.standard_normal(time.size)
    np.savetxt(
        tmp_path / "swing.csv",
        np.column_stack([time, swing]),
        delimiter=",",
        header="time,torque_shaft",
        comments="",
    )
    path = tmp_path / "tests.toml"
    path.write_text(TOML, encoding="utf-8")
    return path


def test_every_recording_gets_its_test(toml: Path, tmp_path: Path) -> None:
    assert find_problems(toml) == ()
    result = identify_file(toml, tmp_path / "found")
    assert load_json(tmp_path / "found.json", "identification")["tests"] == result["tests"]
    step, swing, refused = result["tests"]
    assert (step["method"], step["recording"]) == ("torque_step", "recording_1")
    assert step["values"]["inertia"] == pytest.approx(0.1292) and step["sources"]["inertia"] == "nameplate"
    low, high = step["intervals"]["coulomb"]
    assert low <= 2.0 <= high
    low, high = swing["intervals"]["frequency"]
    assert low <= np.hypot(20.0, 4.0 / (2.0 * np.pi)) <= high  # undamped
    assert "angle_motor" in refused["skipped"]  # what a test refuses is a result
    assert "skipped" in result["fits"]["breakaway, recording 3"]
    assert result["parameters"]["coulomb (torque step, recording 1)"]["unit"] == "Nm"


def test_one_method_alone(toml: Path, tmp_path: Path) -> None:
    result = identify_file(toml, tmp_path / "found", method="ring_down")
    assert [test["method"] for test in result["tests"]] == ["ring_down"]
    assert set(result["parameters"]) == {"frequency", "damping_ratio"}
    with pytest.raises(InvalidInput, match="no recording for locked_backlash"):
        identify_file(toml, tmp_path / "found", method="locked_backlash")


def test_one_saved_recording(tmp_path: Path) -> None:
    plant = lm.Drivetrain(inertias=(0.1292,), frictions=(lm.Friction(2.0, 0.0175),))
    torque = np.r_[np.full(6000, 12.0), np.zeros(4000)]
    lm.io.save_recording(lm.simulate(plant, torque_motor=torque, dt=DT), tmp_path / "step.npz")
    result = identify_file(tmp_path / "step.npz", tmp_path / "found", method="torque_step")
    assert result["parameters"]["inertia"]["value"] == pytest.approx(0.1292, rel=1e-3)


def test_a_run_shows_them_among_the_fits(toml: Path) -> None:
    material = from_configuration(read_configuration(toml))
    found = find_parameters(material).with_tests(single_tests(material))
    assert found.fits["torque step, recording 1"]["coulomb"]["unit"] == "Nm"
    assert found.fits["torque step, recording 1"]["relative error"] < 0.05
    assert found.fits["breakaway, recording 3"]["skipped"]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('use = "torque_steps"', "torque_step"),
        ('use = "ring_down"\noptions = { inertia = 1 }', "unknown option"),
        ('use = "identify"\noptions = { inertia = 1 }', "options are those of a test"),
        ('use = "torque_step"\noptions = { inertia = "3 Nm" }', "kg"),
    ],
)
def test_a_slip_is_named_before_anything_is_read(tmp_path: Path, line: str, message: str) -> None:
    path = tmp_path / "slip.toml"
    path.write_text(f'[[recording]]\nfile = "none.csv"\n{line}\n', encoding="utf-8")
    with pytest.raises(InputProblems, match=message):
        read_configuration(path)


def test_further_signals_are_named_in_the_toml(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(
        '[identify]\nmeasured = ["speed_load"]\n[[recording]]\nfile = "a.csv"\n', encoding="utf-8"
    )
    assert read_configuration(path).identify.measured == ("speed_load",)
    path.write_text(
        '[identify]\nmeasured = ["speed_motor"]\n[[recording]]\nfile = "a.csv"\n', encoding="utf-8"
    )
    with pytest.raises(InputProblems, match="always used"):
        read_configuration(path)


def test_the_lists_are_those_of_the_functions() -> None:
    assert tuple(METHODS) == TESTS
    assert MEASURED == FURTHER
    for name, options in METHODS.items():
        assert tuple(inspect.signature(getattr(identification, name)).parameters)[1:] == options

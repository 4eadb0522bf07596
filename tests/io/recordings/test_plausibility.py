"""What nameplate, law and load speed say against the recording: each slip is told, and gone with its remedy."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lostmotion.io import check_recording, find_problems
from lostmotion.recording import Recording

TIME = 1e-3 * np.arange(1600)
#: A motor of 0.13 kg m² under many frequencies.
TORQUE = sum(3.0 * np.sin(2.0 * np.pi * f * TIME + f) for f in (1.3, 2.9, 4.7, 7.1, 11.3))
SPEED = np.cumsum(TORQUE) * 1e-3 / 0.13
LOAD = np.convolve(SPEED, np.ones(9) / 9.0, "same")
NAMEPLATE = {
    "inertia_motor": 0.02,
    "inertia_load": 0.11,
    "stiffness": 300.0,
    "backlash": 0.01,
    "damping": 0.1,
}
RECORDING = '[[recording]]\nfile = "rig.csv"\n'
#: A torsional mode of 21 Hz, so that 1 ms will do; the load's channel is given where it matters.
LOAD_CHANNEL = (
    "channels = { speed_motor = 1, torque_motor = 2, speed_load = { column = 3, unit = 'rad/s', %s } }\n"
)


def told(folder: Path, further: str = "", load: np.ndarray = LOAD, **nameplate: float) -> list[str]:
    """The warnings of a TOML with these changes."""
    rows = ["time [s],speed_motor [rad/s],torque_motor [Nm],speed_load [rad/s]"]
    rows += [",".join(f"{v:.9g}" for v in row) for row in zip(TIME, SPEED, TORQUE, load, strict=True)]
    (folder / "rig.csv").write_text("\n".join(rows) + "\n")
    values = "".join(f"{name} = {value}\n" for name, value in {**NAMEPLATE, **nameplate}.items())
    (folder / "rig.toml").write_text(
        f"[nameplate]\n{values}{further if '[[recording]]' in further else RECORDING + further}"
    )
    return [str(problem) for problem in find_problems(folder / "rig.toml")]


def test_a_sound_recording_is_not_warned_of(tmp_path: Path) -> None:
    assert told(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "slip", "words"),
    [
        ("backlash", 0.6, "a number alone is in rad"),
        ("lag", 0.3, "a number alone is in s"),
        ("stiffness", 5.0, "winds by"),
        ("stiffness", 3e6, "samples in a period"),
        ("damping", 100.0, "a damping ratio of"),
        ("coulomb", 200.0, "under which the motor was recorded"),
        ("inertia_load", 110.0, "an acceleration as of 0.1"),
    ],
)
def test_a_number_in_another_unit(tmp_path: Path, name: str, slip: float, words: str) -> None:
    (problem,) = told(tmp_path, **{name: slip})
    assert words in problem and ("Check the unit" in problem or "Check unit" in problem)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        ("torque_limit = 8000", "law.torque_limit"),
        ("poles = [-3000, -3000, -3000]", "slower than 1/sample_time"),
    ],
)
def test_a_law_that_cannot_be_meant_for_this_drive(tmp_path: Path, law: str, words: str) -> None:
    (problem,) = told(tmp_path, f"[law]\n{law}\n")
    assert words in problem


@pytest.mark.parametrize(
    ("factor", "words", "remedy"),
    [
        (-1.0, "sign = -1 for speed_load", "sign = -1"),
        (0.2, "scale = 5", "scale = 5"),
        (9.549, "Check its unit", "scale = 0.1047"),
    ],
)
def test_a_load_that_does_not_turn_with_the_motor(
    tmp_path: Path, factor: float, words: str, remedy: str
) -> None:
    (problem,) = told(tmp_path, load=factor * LOAD)
    assert words in problem
    assert told(tmp_path, LOAD_CHANNEL % remedy, load=factor * LOAD) == []


def test_a_load_of_another_recording_and_one_that_is_held(tmp_path: Path) -> None:
    (problem,) = told(tmp_path, load=np.roll(LOAD, 500))
    assert "recorded at the same time" in problem
    assert told(tmp_path, load=1e-4 * LOAD) == []


def test_what_is_not_used_or_used_twice(tmp_path: Path) -> None:
    (again,) = told(tmp_path, RECORDING + RECORDING)
    assert "Only the first is used" in again
    (fitted,) = told(tmp_path, RECORDING + RECORDING + 'use = "validate"\n')
    assert "one that nothing was fitted to" in fitted
    parts = [
        RECORDING + f'use = "{use}"\nwindow = {part}\n'
        for use, part in (("identify", [0, 1.1]), ("validate", [1.1, 2]))
    ]
    assert [problem for problem in told(tmp_path, "".join(parts)) if "fitted" in problem] == []


@pytest.mark.parametrize("mark", [9999.0, -100.0])
def test_a_mark_of_lost_samples(tmp_path: Path, mark: float) -> None:
    (problem,) = told(tmp_path, load=np.where(np.arange(TIME.size) % 200 == 7, mark, LOAD))[:1]
    assert f"{mark:g} in 8 single samples" in problem


def test_a_counter_that_begins_anew_in_each_turn() -> None:
    turning = 60.0 * TIME
    (problem,) = check_recording(Recording(TIME, {"angle_motor": np.mod(turning, 2.0 * np.pi)}))
    assert "The counter overflows" in problem.remedy and "15 times" in problem.got
    assert check_recording(Recording(TIME, {"angle_motor": turning})) == ()

"""A sensor that hangs or is dead, one sample far off, numbers that no drive has; and healthy signals that pass."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InputProblems
from lostmotion.io.recordings.checks import check_recording
from lostmotion.io.recordings.read import read_recording
from lostmotion.recording import Recording

DT = 1e-3
TIME = DT * np.arange(4000)
RNG = np.random.default_rng(2)
TORQUE = 3.0 * np.repeat(RNG.normal(size=1000), 4) + 0.02 * RNG.normal(size=4000)
SPEED = 20.0 * np.sin(9.0 * TIME) + 0.05 * np.cumsum(TORQUE)


def warnings(**signals: np.ndarray) -> list[str]:
    return [f"{p.where}: {p.got}" for p in check_recording(Recording(TIME, signals))]


def written(folder: Path, **signals: np.ndarray) -> Path:
    header = ",".join(["time", *signals])
    np.savetxt(
        folder / "a.csv",
        np.column_stack([TIME, *signals.values()]),
        delimiter=",",
        header=header,
        comments="",
    )
    return folder / "a.csv"


@pytest.mark.parametrize("size", [1e308, -1e13, 1e300])
def test_one_absurd_sample_is_an_error_with_its_line(tmp_path: Path, size: float) -> None:
    speed = SPEED.copy()
    speed[700] = size
    with pytest.raises(InputProblems, match=r"in SI units in line 702 \(1 values\), expected at most 1e\+12"):
        read_recording(written(tmp_path, speed_motor=speed, torque_motor=TORQUE))
    part = read_recording(tmp_path / "a.csv", window=(1.0, 3.0))
    assert len(part) == 2000  # what lies outside the window counts for nothing


@pytest.mark.parametrize("scale", [1e300, 1e-300, 1e-30])
def test_an_absurd_scale_is_an_error(tmp_path: Path, scale: float) -> None:
    path = written(tmp_path, speed_motor=SPEED, torque_motor=TORQUE)
    channels = {"speed_motor": {"column": 1, "scale": scale}, "torque_motor": 2}
    with pytest.raises(InputProblems, match=r"scale: got 1e.*power of ten"):
        read_recording(path, channels=channels)


def test_a_scale_that_makes_absurd_sizes_is_an_error(tmp_path: Path) -> None:
    path = written(tmp_path, speed_motor=SPEED, torque_motor=TORQUE)
    with pytest.raises(InputProblems, match="check unit, scale and offset"):
        read_recording(path, channels={"speed_motor": {"column": 1, "scale": 1e15}, "torque_motor": 2})


@pytest.mark.parametrize(("name", "values"), [("speed_motor", SPEED), ("torque_motor", TORQUE)])
def test_one_sample_far_off_is_told(name: str, values: np.ndarray) -> None:
    spoilt = values.copy()
    spoilt[1500] += 2000.0 * np.max(np.abs(np.diff(values)))
    (warning,) = warnings(**{name: spoilt})
    assert "in one sample, and back in the next, at 1.5 s" in warning
    assert warnings(**{name: values}) == []


def test_steps_and_impacts_are_no_spikes() -> None:
    steps = np.where(TIME < 2.0, 0.0, 500.0) + 1e-3 * RNG.normal(size=4000)
    impact = 1e-3 * RNG.normal(size=4000)
    impact[1000:1004] += [50.0, 90.0, 40.0, -30.0]
    assert warnings(speed_load=steps) == warnings(torque_shaft=impact) == []


def test_a_dead_encoder_is_told_and_a_motor_at_rest_is_not() -> None:
    speed = SPEED.copy()
    speed[2000:3000] = 0.0
    assert any(
        "exactly 0 in 1000 rows on end, from 2 s on" in w
        for w in warnings(torque_motor=TORQUE, speed_motor=speed)
    )
    resting = TORQUE.copy()
    resting[2000:3000] *= 0.1
    assert warnings(torque_motor=resting, speed_motor=speed) == []

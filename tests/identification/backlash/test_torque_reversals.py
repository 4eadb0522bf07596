"""Whether the gap is crossed, judged by the shaft torque."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from lostmotion.identification.backlash.torque_reversals import backlash_excited
from lostmotion.recording import Recording

DATA = Path(os.environ.get("LOSTMOTION_DATA", Path(__file__).parents[3] / ".." / "shared" / "data"))
TIME = np.arange(10_000) * 1e-3


def swinging(offset: float, noise: float = 0.05, name: str = "torque_shaft") -> Recording:
    random = np.random.default_rng(1)
    torque = offset + np.sin(2.0 * np.pi * TIME) + noise * random.standard_normal(TIME.size)
    return Recording(TIME, {name: torque})


def test_every_reversal_counts_once() -> None:
    found = backlash_excited(swinging(0.0))
    assert found.excited is True
    assert found.reversals == 19  # ten periods: twenty half waves
    assert found.noise == pytest.approx(0.05, rel=0.05)
    assert found.problems == ()


def test_noise_around_zero_is_no_reversal() -> None:
    random = np.random.default_rng(2)
    found = backlash_excited(Recording(TIME, {"torque_shaft": 0.1 * random.standard_normal(TIME.size)}))
    assert found.excited is False
    assert found.low < 0.0 < found.high


def test_one_sided_torque_is_not_excited() -> None:
    found = backlash_excited(swinging(1.5))
    assert found.excited is False
    assert "not excited" in found.problems[0].got


def test_estimated_torque_stands_in() -> None:
    found = backlash_excited(swinging(0.0, name="torque_shaft_estimated"))
    assert found.excited is True
    assert found.signal == "torque_shaft_estimated"


def test_without_shaft_torque_the_answer_is_open() -> None:
    found = backlash_excited(swinging(0.0, name="torque_motor"))
    assert found.excited is None
    assert "no such signal" in found.problems[0].got


@pytest.mark.parametrize("name", ["step_sensor.csv", "sin_sensor.csv"])
def test_measured_rig_never_reverses(name: str) -> None:
    path = DATA / "aalto" / name
    if not path.exists():
        pytest.skip(f"no {path}: set LOSTMOTION_DATA to the folder of measured data")
    columns = np.loadtxt(path, delimiter=",", unpack=True)
    found = backlash_excited(Recording(columns[0], {"torque_shaft": columns[3]}))
    assert found.excited is False
    assert found.low > 0.0

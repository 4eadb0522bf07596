"""The step that the laws are compared on: from the drive's own speeds, as far as its torque goes, until it settles."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion.drivetrain import Drivetrain
from lostmotion.recording import Recording
from lostmotion.stages.speed_step import MOST_ROWS, PAPER_STEP, SpeedStep, speed_step

DT = 1e-4

DRIVE = Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, coulomb=2.0)


def recorded(low: float, high: float) -> Recording:
    time = np.linspace(0.0, 1.0, 1000)
    return Recording(
        time=time, signals={"speed_motor": 0.5 * (high + low) + 0.5 * (high - low) * np.sin(20.0 * time)}
    )


def step(recording: Recording | None, limit: float = math.inf, slowest: float = 100.0) -> SpeedStep:
    return speed_step(recording, DRIVE, limit, slowest, 0.0, DT)


def test_within_the_recorded_speeds_in_both_directions() -> None:
    found = step(recorded(-10.0, 40.0))
    assert found.high == -found.low and 4.5 < found.high <= 5.0


def test_an_axis_that_turns_one_way_is_not_reversed() -> None:
    found = step(recorded(20.0, 60.0))
    assert 20.0 < found.low < found.high < 60.0


def test_no_larger_than_the_torque_limit_can_follow() -> None:
    wide = recorded(-100.0, 100.0)
    assert step(wide, limit=10.0).high < step(wide, limit=100.0).high < step(wide).high
    # Twice the torque beyond friction, twice the step.
    assert step(wide, limit=18.0).high == pytest.approx(2.0 * step(wide, limit=10.0).high)


def test_a_slow_law_gets_its_time() -> None:
    fast, slow = step(recorded(-10.0, 10.0)), step(recorded(-10.0, 10.0), slowest=1.0)
    assert slow.start > 50.0 * fast.start
    assert slow.stop - slow.start >= 12.0 / 1.0
    assert slow.longer(DT).end == 2.0 * slow.end


def test_a_law_that_is_far_too_slow_gets_no_more_rows_than_there_is_room_for() -> None:
    """Of a 12 bit encoder at 0.2 ms: 134 000 s, which ended in an array of 28 GB."""
    slow = step(None, slowest=1e-4)
    assert slow.reference(DT).size == pytest.approx(MOST_ROWS, rel=1e-3)
    assert slow.longer(DT) == slow


def test_without_a_recorded_speed_it_is_the_paper_s() -> None:
    found = step(None)
    assert (found.low, found.high) == (PAPER_STEP.low, PAPER_STEP.high)


def test_the_reference_of_the_paper_s_step() -> None:
    reference = PAPER_STEP.reference(1e-3)
    assert reference.size == 2000
    assert [reference[i] for i in (0, 999, 1000, 1499, 1500)] == [-2.0, -2.0, 2.0, 2.0, -2.0]
    assert PAPER_STEP.without_return().reference(1e-3)[-1] == 2.0

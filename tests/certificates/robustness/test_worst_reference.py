"""The worst set-point: that of a linear loop is known, and no square wave is worse."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import worst_reference
from lostmotion.errors import InvalidInput

LAW = lm.controllers.pi(dt=1e-4)
RIGID = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=4.0, viscous=0.0175
)


def test_it_finds_the_worst_of_a_linear_loop() -> None:
    """The set-point's limit times the sum of the impulse response's size."""
    step = lm.simulate(RIGID, law=LAW, dt=1e-4, speed_reference=np.ones(4000))
    worst = np.abs(np.diff(step["speed_motor"])).sum()
    found = worst_reference(RIGID, LAW, 1.0, "speed_motor", starts=1)
    assert 0.999 * worst < found.peak < 1.001 * worst
    assert set(np.unique(found.reference)) == {-1.0, 1.0}


def test_its_peak_is_that_of_its_set_point_and_above_square_waves() -> None:
    found = worst_reference(PAPER, LAW, 0.5, "speed_motor", starts=1)
    run = lm.simulate(PAPER, law=LAW, dt=1e-4, speed_reference=found.reference)
    assert np.max(np.abs(run["speed_motor"])) == found.peak
    time = np.arange(4000) + 0.5
    for period in np.geomspace(30, 2000, 12):
        square = lm.simulate(
            PAPER, law=LAW, dt=1e-4, speed_reference=0.5 * np.sign(np.sin(2.0 * np.pi * time / period))
        )
        assert np.max(np.abs(square["speed_motor"])) < found.peak


def test_the_delay_is_part_of_the_loop() -> None:
    """A delay of 25 samples takes most of PI's phase margin: the worst peak grows."""
    peaks = [
        worst_reference(PAPER, LAW, 0.5, "speed_motor", delay=delay, starts=1, duration=0.1).peak
        for delay in (0, 25)
    ]
    assert peaks[1] > 1.1 * peaks[0]


def test_no_limit_and_too_short_a_time_are_refused() -> None:
    with pytest.raises(InvalidInput, match="positive"):
        worst_reference(PAPER, LAW, 0.0, "twist")
    with pytest.raises(InvalidInput, match="duration"):
        worst_reference(PAPER, LAW, 1.0, "twist", duration=1e-3)

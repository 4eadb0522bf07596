"""Bounds of all motions: integrals that are known, simulations that stay within, and how far above them they are."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import continuous_pi, peak_bounds
from lostmotion.certificates.rational import rational
from lostmotion.certificates.robustness.peak_integrals import peak_integrals
from lostmotion.errors import InvalidInput


def test_integrals_of_known_impulse_responses() -> None:
    """A lag: 1/rate. A swing e^(−a·t)·sin(b·t): coth(π·a/2b)·b/(a² + b²)."""
    lag = peak_integrals(rational([[-4.0]]), rational([[3.0]]), rational([[-2.0]]))
    assert lag is not None and 1.5 <= lag[0, 0] <= 1.5 * (1.0 + 1e-3)
    a, b = 2.0, 30.0
    swing = peak_integrals(rational([[-a, b], [-b, -a]]), rational([[0.0], [1.0]]), rational([[1.0, 0.0]]))
    exact = b / (a**2 + b**2) / np.tanh(np.pi * a / (2.0 * b))
    assert swing is not None and exact <= swing[0, 0] <= exact * (1.0 + 2e-3)
    assert peak_integrals(rational([[Fraction(1)]]), rational([[1.0]]), rational([[1.0]])) is None, "it grows"


def worst_simulated(reference: float) -> np.ndarray:
    """Largest twist, speeds and torque over square waves of many periods."""
    dt, samples, law = 1e-4, 4000, lm.controllers.pi(dt=1e-4)
    worst = np.zeros(4)
    for period in np.geomspace(30, 2000, 12):
        square = reference * np.sign(np.sin(2.0 * np.pi * (np.arange(samples) + 0.5) / period))
        run = lm.simulate(PAPER, law=law, dt=dt, speed_reference=square)
        names = ("twist", "speed_motor", "speed_load", "torque_motor")
        worst = np.maximum(worst, [np.max(np.abs(run[name])) for name in names])
    return worst


def test_no_simulation_exceeds_the_bounds_and_they_are_not_far_off() -> None:
    bounds = peak_bounds(PAPER, continuous_pi(), 5.0)
    found = np.array([bounds.twist, bounds.speed_motor, bounds.speed_load, bounds.torque_motor])
    ratio = found / worst_simulated(5.0)
    assert np.all(ratio >= 1.0) and np.all(ratio <= 2.5), ratio


def test_whether_the_torque_limit_can_act() -> None:
    still = peak_bounds(PAPER.with_parameters(torque_limit=73.5), continuous_pi())
    assert still.limit_acts is False and still.torque_motor < 25.0
    assert peak_bounds(PAPER.with_parameters(torque_limit=20.0), continuous_pi()).limit_acts is None


def test_what_is_not_bounded_is_refused() -> None:
    with pytest.raises(InvalidInput, match="stable"):
        peak_bounds(PAPER, continuous_pi(kp=-10.0))
    with pytest.raises(InvalidInput, match="lag"):
        peak_bounds(PAPER.with_parameters(lag=1e-3), continuous_pi())

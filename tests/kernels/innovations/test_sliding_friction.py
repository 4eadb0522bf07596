"""Friction that rises towards rest, over a piece in which the speed changes steadily."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.kernels.innovations.sliding_friction import friction_slope, mean_friction, sliding_friction

LEVEL, RISE, FADE = 2.0, 0.4, 0.3
CURVE = LEVEL, RISE, FADE


def friction(speed: np.ndarray) -> np.ndarray:
    return np.copysign(LEVEL, speed) * (1.0 + RISE * np.exp(-np.abs(speed) / FADE))


@pytest.mark.parametrize(("first", "last"), [(0.5, 0.1), (-0.2, -0.9), (0.4, 0.4 + 1e-7), (3.0, 2.0)])
def test_mean_and_slope_are_those_of_the_curve_between_two_speeds(first: float, last: float):
    per_torque = -0.01
    mean, rests = mean_friction(first, last - per_torque * np.copysign(LEVEL, first), per_torque, *CURVE)
    between = np.linspace(first, last, 10_001)
    assert mean == pytest.approx(np.trapezoid(friction(between)) / 10_000, rel=1e-6) and not rests
    slope = (friction(between[-1:]) - friction(between[:1]))[0] / (last - first)
    assert friction_slope(first, last, *CURVE) == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("rise", [0.0, RISE])
@pytest.mark.parametrize(("first", "free"), [(0.5, 0.1), (-0.2, -0.9), (0.4, 0.42), (0.1, 0.05)])
def test_while_it_slides_its_change_is_that_of_the_mean(first: float, free: float, rise: float):
    torque, slope = sliding_friction(first, free, -0.01, LEVEL, rise, FADE)
    assert torque == mean_friction(first, free, -0.01, LEVEL, rise, FADE)[0]
    higher = mean_friction(first, free + 1e-7, -0.01, LEVEL, rise, FADE)[0]
    assert slope == pytest.approx((higher - torque) / 1e-7, rel=1e-4, abs=1e-6)


def test_at_rest_the_friction_holds_up_to_its_highest_level():
    top = LEVEL * (1.0 + RISE)
    for wanted, held in ((0.99 * top, True), (1.01 * top, False), (-1.01 * top, False)):
        torque, rests = mean_friction(0.0, 0.01 * wanted, -0.01, *CURVE)
        assert rests is held
        assert torque == pytest.approx(wanted if held else np.sign(wanted) * abs(wanted) / 1.01)


def test_what_stops_within_the_piece_slips_until_then():
    """Twice as fast to rest as the piece lasts: half of it slips, half is held."""
    per_torque = -1.0
    slips = mean_friction(1e9, 1e9, per_torque, LEVEL, 0.0, 0.0)[0]
    torque, rests = mean_friction(1.0, 1.0, per_torque, LEVEL, 0.0, 0.0)
    assert slips == LEVEL and rests
    assert torque == pytest.approx(0.5 * LEVEL + 0.5 * 0.0)


def test_a_friction_that_does_not_rise_has_no_slope():
    assert friction_slope(0.5, 0.1, LEVEL, 0.0, 0.0) == 0.0
    assert friction_slope(0.5, -0.1, *CURVE) == 0.0

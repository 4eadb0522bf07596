"""Piecewise-linear curves: values, slopes, and what they refuse."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion.curves import PiecewiseLinear, dead_zone, saturation
from lostmotion.errors import InvalidInput

Z = np.linspace(-3.0, 3.0, 61)


def test_dead_zone_is_its_definition():
    np.testing.assert_allclose(dead_zone(1.0, 2.0)(Z), 2.0 * (Z - np.clip(Z, -1.0, 1.0)), atol=1e-15)
    np.testing.assert_array_equal(dead_zone(0.0, 2.0)(Z), 2.0 * Z)


def test_saturation_is_its_definition():
    np.testing.assert_allclose(saturation(1.5, 2.0)(Z), np.clip(2.0 * Z, -1.5, 1.5), atol=1e-15)
    np.testing.assert_array_equal(saturation(0.0)(Z), 0.0)


def test_curve_through_its_points():
    curve = PiecewiseLinear(((-1, 2), (0, 0), (2, 1)), slope_left=-3.0, slope_right=0.5)
    np.testing.assert_array_equal(curve([-1.0, 0.0, 2.0]), [2.0, 0.0, 1.0])
    np.testing.assert_allclose(curve([-2.0, -0.5, 1.0, 4.0]), [5.0, 1.0, 0.5, 2.0])
    assert curve.slopes == (-3.0, -2.0, 0.5, 0.5)
    assert curve(np.zeros((2, 3))).shape == (2, 3)


@pytest.mark.parametrize(
    "make",
    [
        lambda: PiecewiseLinear(()),
        lambda: PiecewiseLinear(((0.0, math.nan),)),
        lambda: PiecewiseLinear(((0.0, 0.0),), slope_left=math.inf),
        lambda: PiecewiseLinear(((1.0, 0.0), (1.0, 2.0))),
        lambda: dead_zone(-1.0),
        lambda: saturation(-1.0),
        lambda: saturation(1.0, 0.0),
    ],
)
def test_bad_curves_are_refused(make):
    with pytest.raises(InvalidInput):
        make()

"""Sectors of curves from a point on them, against chords to many other points."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from lostmotion.certificates.static_curves import StaticCurve, normalised
from lostmotion.curves import PiecewiseLinear, dead_zone, saturation


@pytest.mark.parametrize(
    "curve",
    [
        dead_zone(0.006),
        saturation(2.0, slope=3.0),
        PiecewiseLinear(((-1.0, -2.0), (0.0, 0.0), (2.0, 1.0)), 0.5, 0.25),
    ],
)
@pytest.mark.parametrize("z", [-0.4, 0.002, 0.1, 3.0])
def test_no_chord_leaves_the_sector_and_some_reach_it(curve: PiecewiseLinear, z: float) -> None:
    a, b, sigma = normalised(curve)
    low, high = (float(a + b * slope) for slope in sigma.sector(Fraction(z)))
    low, high = min(low, high), max(low, high)
    others = z + np.concatenate(
        [
            np.geomspace(1e-6, 1e6, 20_001),
            -np.geomspace(1e-6, 1e6, 20_001),
            [point - z for point, _ in curve.points],
        ]
    )
    chords = (curve(others) - curve(z)) / (others - z)
    assert low - 1e-9 <= chords.min() and chords.max() <= high + 1e-9
    assert chords.min() == pytest.approx(low, abs=1e-3) and chords.max() == pytest.approx(high, abs=1e-3)


def test_a_dead_zone_and_a_saturation_are_copies_of_one_curve() -> None:
    a, b, gap = normalised(dead_zone(0.006))
    c, d, limit = normalised(saturation(0.006))
    assert gap == limit
    assert (float(a), float(b), float(c), float(d)) == (1.0, -0.012, 0.0, 0.012)


def test_coulomb_friction_has_a_finite_sector_away_from_rest() -> None:
    friction = StaticCurve(((Fraction(0), Fraction(-2)), (Fraction(0), Fraction(2))))
    assert friction.sector(Fraction(1, 2)) == (0, 8), "2·M_c/r"
    assert friction.steepest is None and friction.rises and friction.is_odd
    with pytest.raises(ValueError, match="point"):
        friction.sector(Fraction(0))

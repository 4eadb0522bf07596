"""Numbers as people read them."""

from __future__ import annotations

import math

import pytest

from lostmotion.display import numbers


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.01213, "rad", "12.1\u00a0mrad"),
        (1.5, "rad", "1.50\u00a0rad"),
        (3.6e-4, "s", "360\u00a0µs"),
        (-0.0042, "s", "−4.20\u00a0ms"),
        (6285.896, "Nm/rad", "6286\u00a0Nm/rad"),
        (0.0182, "kg m2", "0.0182\u00a0kg m²"),
        (2.5e-9, "Nm", "2.50·10⁻⁹\u00a0Nm"),
        (0.0, "Nm", "0\u00a0Nm"),
        (99.96, "", "100"),
        (None, "Nm", "–"),
        (math.nan, "Nm", "–"),
        (math.inf, "Nm", "–"),
        (True, "Nm", "–"),
    ],
)
def test_quantity(value, unit, text):
    assert numbers.quantity(value, unit) == text


def test_digits_follow_the_interval():
    assert numbers.with_interval(0.01213, 0.01205, 0.01221, "rad") == ("12.13\u00a0mrad", "12.05 … 12.21")
    assert numbers.with_interval(110.61, 109.8, 111.4, "Nm/rad") == ("110.6\u00a0Nm/rad", "109.8 … 111.4")
    assert numbers.with_interval(0.31, 0.06, 0.56, "Nm s/rad") == ("0.31\u00a0Nm·s/rad", "0.06 … 0.56")
    assert numbers.with_interval(0.0, 0.0, 0.0, "Nm") == ("0\u00a0Nm", "0 … 0")
    assert numbers.with_interval(0.0013, None, None, "kg m2") == ("0.0013\u00a0kg m²", "–")
    assert numbers.with_interval(None, None, None, "rad") == ("–", "–")


def test_percentages():
    assert numbers.percent(0.00157) == "0.16\u00a0%"
    assert numbers.percent(3e-7) == numbers.percent(1.3e-5) == "< 0.01\u00a0%"
    assert numbers.percent(0.0) == "0\u00a0%"
    assert numbers.half_width(100.0, 99.0, 101.0) == "±\u00a01.0\u00a0%"
    assert numbers.half_width(0.0, -1.0, 1.0) == "–"
    assert numbers.deviation(99.0, 100.0) == "−1.0\u00a0%"
    assert numbers.deviation(1.0, None) == "–"


def test_a_deviation_is_no_finer_than_its_interval():
    assert numbers.deviation(0.4228, 0.3683, 0.24, 0.74) == "+15\u00a0%"
    assert numbers.deviation(114.8, 100.0, 99.0, 131.0) == "+15\u00a0%"
    assert numbers.deviation(99.25, 100.0, 97.3, 101.2) == "−0.8\u00a0%"
    assert numbers.deviation(99.25, 100.0, 99.2499, 99.2501) == "−0.8\u00a0%"
    assert numbers.deviation(99.25, 100.0, 99.25, 99.25) == "−0.8\u00a0%"
    assert numbers.deviation(99.7, 100.0, 91.0, 109.0) == "0\u00a0%"

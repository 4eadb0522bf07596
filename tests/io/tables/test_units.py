"""Units: the table against hand values, spellings, errors."""

from __future__ import annotations

import math

import pytest

from lostmotion.errors import InvalidInput
from lostmotion.io.tables.units import UNITS, is_unit, known_units, parse_quantity, unit_factor


@pytest.mark.parametrize(
    ("text", "dimension", "expected"),
    [
        ("0.1 ms", "s", 1e-4),
        ("100µs", "s", 1e-4),
        ("100 μs", "s", 1e-4),
        ("2 min", "s", 120.0),
        ("60 rpm", "rad/s", 2 * math.pi),
        ("60 U/min", "rad/s", 2 * math.pi),
        ("60 1/min", "rad/s", 2 * math.pi),
        ("180 °/s", "rad/s", math.pi),
        ("12 mrad", "rad", 0.012),
        ("0.5 rev", "rad", math.pi),
        ("180 deg", "rad", math.pi),
        ("73.5 Nm", "Nm", 73.5),
        ("73.5 N m", "Nm", 73.5),
        ("5 kNm", "Nm", 5000.0),
        ("45.8 mNm", "Nm", 0.0458),
        ("180 kgcm2", "kg m2", 0.018),
        ("180 kg·cm²", "kg m2", 0.018),
        ("1200 g cm^2", "kg m2", 1.2e-4),
        ("0.018 kgm2", "kg m2", 0.018),
        ("109.7 Nm/deg", "Nm/rad", 109.7 * 180 / math.pi),
        ("0.397 Nms/rad", "Nm s/rad", 0.397),
        ("0.397 Nm s/rad", "Nm s/rad", 0.397),
        ("-1.5e-3 A", "A", -1.5e-3),
        ("10 kHz", "Hz", 1e4),
        ("3", "Nm", 3.0),
        (3, "Nm", 3.0),
        (0.25, "Nm", 0.25),
    ],
)
def test_parse_quantity(text: object, dimension: str, expected: float) -> None:
    assert parse_quantity(text, dimension) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    "bad", ["", "ms", "1,5 ms", "1 2 ms", True, None, [1.0], math.nan, math.inf, "nan s"]
)
def test_no_number_is_refused(bad: object) -> None:
    with pytest.raises(InvalidInput, match=r"law\.sample_time"):
        parse_quantity(bad, "s", "law.sample_time")


def test_unknown_unit_lists_the_known_ones_and_the_nearest() -> None:
    with pytest.raises(InvalidInput) as caught:
        parse_quantity("3 Rpm", "rad/s", "speed")
    problem = caught.value.problem
    assert problem.got == "unknown unit 'Rpm'"
    assert all(unit in problem.expected for unit in ("rpm", "rad/s", "U/min", "deg/s"))
    assert "'rpm'" in problem.remedy.replace("RPM", "rpm")


def test_unit_of_another_dimension_is_refused() -> None:
    with pytest.raises(InvalidInput, match=r"a unit of s: s, ms"):
        parse_quantity("3 Nm", "s")


def test_counts_need_counts_per_revolution() -> None:
    assert unit_factor("counts", "x", counts_per_rev=4096) == (2 * math.pi / 4096, "rad")
    assert unit_factor("counts/s", "x", counts_per_rev=4096) == (2 * math.pi / 4096, "rad/s")
    with pytest.raises(InvalidInput, match="counts_per_rev"):
        unit_factor("counts", "x")


def test_every_unit_is_known_under_its_own_name() -> None:
    for dimension, units in UNITS.items():
        for unit, factor in units.items():
            assert unit_factor(unit, "x") == (factor, dimension)
            assert is_unit(unit) and unit in known_units(dimension)
    assert not is_unit("Speed")

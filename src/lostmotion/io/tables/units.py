"""Units of files and TOML, converted to the SI floats that the package uses inside."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping
from types import MappingProxyType

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...plain_data import shown

_DEG = math.pi / 180.0
_REV = 2.0 * math.pi
_RPM = 2.0 * math.pi / 60.0

#: Factor to SI of every known unit, by dimension; a dimension is named by its SI unit (physics).
UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, "d": 86400.0},
        "Hz": {"Hz": 1.0, "kHz": 1e3},
        "rad": {
            "rad": 1.0,
            "mrad": 1e-3,
            "urad": 1e-6,
            "deg": _DEG,
            "arcmin": _DEG / 60.0,
            "rev": _REV,
            "U": _REV,
        },
        "rad/s": {
            "rad/s": 1.0,
            "mrad/s": 1e-3,
            "deg/s": _DEG,
            "rpm": _RPM,
            "RPM": _RPM,
            "U/min": _RPM,
            "1/min": _RPM,
            "min-1": _RPM,
            "rev/min": _RPM,
            "rev/s": _REV,
        },
        "Nm": {"Nm": 1.0, "mNm": 1e-3, "Ncm": 1e-2, "kNm": 1e3},
        "kg m2": {"kg m2": 1.0, "g m2": 1e-3, "kg cm2": 1e-4, "g cm2": 1e-7, "kg mm2": 1e-6},
        "Nm/rad": {"Nm/rad": 1.0, "mNm/rad": 1e-3, "kNm/rad": 1e3, "Nm/mrad": 1e3, "Nm/deg": 1.0 / _DEG},
        "Nm s/rad": {
            "Nm s/rad": 1.0,
            "Nm s": 1.0,
            "mNm s/rad": 1e-3,
            "Nm s/deg": 1.0 / _DEG,
            "Nm/rpm": 1.0 / _RPM,
        },
        "A": {"A": 1.0, "mA": 1e-3},
        "V": {"V": 1.0, "mV": 1e-3},
        "N": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
        "m": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
        "m/s": {"m/s": 1.0, "mm/s": 1e-3},
        "1": {"1": 1.0, "%": 1e-2},
    }
)

#: Units of an encoder: their factor is 2π / counts per revolution.
COUNT_UNITS: Mapping[str, str] = MappingProxyType({"counts": "rad", "counts/s": "rad/s"})

_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)", re.ASCII | re.DOTALL)
#: Longest unit that is compared with the known ones, characters (option).
_LONGEST = 40
_SPELLINGS = str.maketrans(
    {"²": "2", "µ": "u", "μ": "u", "°": "deg", "^": "", "*": "", "·": "", " ": "", "⁻": "-", "¹": "1"}
)


def _spelling(unit: str) -> str:
    return unit.translate(_SPELLINGS)


_BY_SPELLING = {_spelling(u): (factor, dim) for dim, units in UNITS.items() for u, factor in units.items()}


def known_units(dimension: str = "") -> tuple[str, ...]:
    """The units that can be written, of one dimension (named by its SI unit) or of all."""
    if dimension:
        counts = [unit for unit, dim in COUNT_UNITS.items() if dim == dimension]
        return (*UNITS.get(dimension, {}), *counts)
    return (*(unit for units in UNITS.values() for unit in units), *COUNT_UNITS)


def is_unit(text: str) -> bool:
    """Whether the text is a unit of the table, in any spelling (``kgm2``, ``kg·m²``, ``µs``, ``°/s``)."""
    return _spelling(text) in _BY_SPELLING or _spelling(text) in COUNT_UNITS


def unit_factor(
    unit: str, where: str, dimension: str = "", counts_per_rev: float | None = None
) -> tuple[float, str]:
    """Factor to SI and dimension of a unit.

    Parameters
    ----------
    unit : str
        Spelt as in ``UNITS`` or with ``²``, ``^2``, ``·``, ``µ``, ``°``, with or without blanks.
    where : str
        The place named in an error.
    dimension : str
        Of what is expected there; only shortens the list of units in the error.
    counts_per_rev : float, optional
        Needed for ``counts`` and ``counts/s``: counts after evaluation (four times the lines).

    Raises
    ------
    InvalidInput
        If the unit is unknown, or is counts without counts per revolution.
    """
    spelt = _spelling(unit)
    if spelt in COUNT_UNITS:
        if counts_per_rev is None or not counts_per_rev > 0.0:
            raise InvalidInput(
                where,
                f"unit {unit!r}, counts_per_rev {counts_per_rev!r}",
                "the counts per revolution",
                "Add counts_per_rev, e.g. 4096 (four times the encoder's lines).",
            )
        return _REV / counts_per_rev, COUNT_UNITS[spelt]
    if spelt in _BY_SPELLING:
        return _BY_SPELLING[spelt]
    known = known_units(dimension) or known_units()
    by_lower_case = {_spelling(u).lower(): u for u in known_units()}
    close = difflib.get_close_matches(spelt.lower()[:_LONGEST], by_lower_case, n=1)
    hint = f"Did you mean {by_lower_case[close[0]]!r}?" if close else "Use a known unit and a scale."
    raise InvalidInput(where, f"unknown unit {shown(unit)}", "one of " + ", ".join(known), hint)


@checks_arguments
def parse_quantity(value: object, dimension: str, where: str = "quantity") -> float:
    """A number in SI, or a string of number and unit, as a float in SI.

    Parameters
    ----------
    value : float or str
        ``0.0001`` or ``"0.1 ms"``; a string without a unit counts as SI.
    dimension : str
        SI unit of what is expected: ``"s"``, ``"kg m2"``, ``"Nm s/rad"`` …
    where : str
        The place named in an error.

    Raises
    ------
    InvalidInput
        If it is no finite number, or the unit is unknown or of another dimension.
    """
    if dimension not in UNITS:
        raise InvalidInput(
            "parse_quantity.dimension", shown(dimension), ", ".join(UNITS), "Name one of them."
        )
    example = f'a number in {dimension}, or text such as "1.5 {next(iter(UNITS[dimension]))}"'
    match = _NUMBER.fullmatch(value.strip()) if isinstance(value, str) else None
    if match is None and (isinstance(value, bool) or not isinstance(value, int | float)):
        raise InvalidInput(
            where, shown(value), example, "Write the number with a decimal point, then the unit."
        )
    try:
        number = float(match[1] if match else value)  # type: ignore[arg-type]
    except OverflowError:  # a whole number beyond 1e308
        number = math.inf
    unit = match[2] if match else ""
    if re.match(r",\d", unit):
        raise InvalidInput(where, shown(value), "a decimal point", "Write 0.5 for a half, not 0,5.")
    factor, found = unit_factor(unit, where, dimension) if unit else (1.0, dimension)
    if found != dimension:
        raise InvalidInput(
            where, shown(value), f"a unit of {dimension}: {', '.join(UNITS[dimension])}", "Check the unit."
        )
    if not math.isfinite(number * factor):
        raise InvalidInput(
            where, shown(value), f"a finite {example.removeprefix('a ')}", "Replace it or leave it out."
        )
    return number * factor

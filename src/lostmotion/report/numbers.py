"""Numbers for people: sensible digits, a unit and a prefix that keep them short."""

from __future__ import annotations

import math
from typing import Any, TypeGuard

#: Shown when there is no number.
NONE = "–"

_PREFIXES = {  # unit: (below this, factor, shown unit), smallest last; chosen for three to four digits
    "rad": ((0.5, 1e3, "mrad"),),
    "s": ((0.5, 1e3, "ms"), (0.5e-3, 1e6, "µs")),
}
_PRETTY = {"kg m2": "kg m²", "Nm s/rad": "Nm·s/rad", "1": ""}


def is_number(value: Any) -> TypeGuard[float]:
    """Whether a value is a finite real number, and no truth value."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def digits(value: Any, significant: int = 3) -> str:
    """A number with so many significant digits, without exponent from 0.001 to 999 999."""
    if not is_number(value):
        return NONE
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(float(f"{value:.{significant - 1}e}"))))
    if size < -3 or size > 5:
        mantissa, exponent = f"{value:.{significant - 1}e}".split("e")
        return f"{mantissa}·10{_superscript(int(exponent))}".replace("-", "−")
    return f"{value:.{max(0, significant - 1 - size)}f}".replace("-", "−")


def quantity(value: Any, unit: str = "", significant: int = 3) -> str:
    """A number with its unit: 0.01213 rad → "12.1 mrad"."""
    factor, shown = _prefix(value, unit)
    text = digits(value * factor, significant) if is_number(value) else NONE
    return f"{text} {shown}".strip() if text != NONE else NONE


def interval(value: Any, low: Any, high: Any, unit: str) -> str:
    """ "12.05 … 12.21 mrad": both ends with as many decimals as two digits of the half width need."""
    if not (is_number(low) and is_number(high)):
        return NONE
    factor, shown = _prefix(value, unit)
    half = 0.5 * abs(high - low) * factor
    if half == 0.0 or half < 1e-6 * abs(high * factor):
        return f"{digits(low * factor, 4)} … {digits(high * factor, 4)} {shown}".strip()
    places = max(0, 1 - math.floor(math.log10(half)))
    return f"{low * factor:.{places}f} … {high * factor:.{places}f} {shown}".strip().replace("-", "−")


def percent(fraction: Any, significant: int = 2) -> str:
    """A fraction in per cent: 0.0042 → "0.42 %"."""
    return f"{digits(100.0 * fraction, significant)} %" if is_number(fraction) else NONE


def half_width(value: Any, low: Any, high: Any) -> str:
    """Half the interval in per cent of the value: "± 0.66 %"."""
    if not (is_number(value) and is_number(low) and is_number(high)) or value == 0:
        return NONE
    return f"± {percent(0.5 * (high - low) / abs(value))}"


def deviation(value: Any, reference: Any) -> str:
    """How far a value is from a reference, in per cent of the reference, signed."""
    if not (is_number(value) and is_number(reference)) or reference == 0:
        return NONE
    return f"{100.0 * (value - reference) / abs(reference):+.1f} %".replace("-", "−")


def _prefix(value: Any, unit: str) -> tuple[float, str]:
    factor, shown = 1.0, _PRETTY.get(unit, unit)
    for below, new_factor, new_unit in _PREFIXES.get(unit, ()):
        if is_number(value) and 0.0 < abs(value) < below:
            factor, shown = new_factor, new_unit
    return factor, shown


def _superscript(number: int) -> str:
    return str(number).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))

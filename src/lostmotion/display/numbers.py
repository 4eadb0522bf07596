"""Numbers for people: sensible digits, a unit and a prefix that keep them short."""

from __future__ import annotations

import math
from typing import Any, TypeGuard

#: Shown when there is no number.
NONE = "–"
#: With more decimals than this, a number is shown with an exponent (option: more zeros are not counted).
SMALLEST_PLACES = 8

_PREFIXES = {  # unit: (below this, factor, shown unit), smallest last; chosen for three to four digits
    "rad": ((0.5, 1e3, "mrad"),),
    "s": ((0.5, 1e3, "ms"), (0.5e-3, 1e6, "µs")),
}
_PRETTY = {"kg m2": "kg m²", "Nm s/rad": "Nm·s/rad", "1": ""}


def is_number(value: Any) -> TypeGuard[float]:
    """Whether a value is a finite real number, and no truth value."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def digits(value: Any, significant: int = 3) -> str:
    """A number with so many significant digits, without exponent from 0.0001 to 999 999."""
    if not is_number(value):
        return NONE
    if value == 0:
        return "0"
    size = math.floor(math.log10(abs(float(f"{value:.{significant - 1}e}"))))
    if size < -4 or size > 5:
        mantissa, exponent = f"{value:.{significant - 1}e}".split("e")
        return f"{mantissa}·10{_superscript(int(exponent))}".replace("-", "−")
    return _fixed(value, max(0, significant - 1 - size))


def quantity(value: Any, unit: str = "", significant: int = 3) -> str:
    """A number with its unit: 0.01213 rad → "12.1 mrad"."""
    if not is_number(value):
        return NONE
    factor, shown = _prefix(value, unit)
    return _with_unit(digits(value * factor, significant), shown)


def given(value: Any, unit: str) -> str:
    """A number without interval, up to four significant digits and no trailing zeros."""
    if not is_number(value):
        return NONE
    factor, shown = _prefix(value, unit)
    text = digits(value * factor, 4)
    return _with_unit(text.rstrip("0").rstrip(".") if "." in text and "·" not in text else text, shown)


def _places(half: float) -> int:
    """Decimals down to the first digit of a half width, one more if that is 1 or 2."""
    size = math.log10(half)
    return max(0, -math.floor(size) + (size % 1.0 < math.log10(3.0)))


def with_interval(value: Any, low: Any, high: Any, unit: str) -> tuple[str, str]:
    """("12.13 mrad", "12.05 … 12.21"): down to the half width's first digit, one more if it is 1 or 2."""
    if not (is_number(value) and is_number(low) and is_number(high)):
        return given(value, unit), NONE
    factor, shown = _prefix(value, unit)
    middle, left, right = (
        _fixed(v * factor, _common(low * factor, high * factor)) for v in (value, low, high)
    )
    return _with_unit(middle, shown), f"{left} … {right}"


def rounded(value: Any, low: Any, high: Any) -> tuple[str, str, str]:
    """As ``with_interval``, but without unit and prefix, and each for itself: ("0.01213", "0.01205", "0.01221").

    Very small numbers have exponents, each its own. What is missing is "–".
    """
    if not (is_number(low) and is_number(high)):
        return (digits(value, 4) if is_number(value) else NONE), NONE, NONE
    places, largest = _common(low, high), max(abs(low), abs(high))
    numbers = (value, low, high)
    if places > SMALLEST_PLACES and largest > 0.0:
        first = math.floor(math.log10(largest))
        texts = [digits(v, max(places + first + 1, 1)) if is_number(v) else NONE for v in numbers]
    else:
        texts = [_fixed(v, places) if is_number(v) else NONE for v in numbers]
    return texts[0], texts[1], texts[2]


def _common(low: float, high: float) -> int:
    """Decimals for a value and both ends of its interval."""
    half, largest = 0.5 * abs(high - low), max(abs(low), abs(high))
    return _places(max(half, 1e-6 * largest)) if largest else 0


def _fixed(value: float, places: int) -> str:
    return f"{value:.{places}f}".replace("-", "−")


def _with_unit(text: str, unit: str) -> str:
    """Joined by a no-break space, so that no line ends between a number and its unit."""
    return f"{text}\u00a0{unit}" if unit else text


def percent(fraction: Any, significant: int = 2) -> str:
    """A fraction in per cent: 0.0042 → "0.42 %"; below a hundredth of a per cent only that it is."""
    if is_number(fraction) and 0.0 < abs(fraction) < 1e-4:
        return _with_unit("< 0.01", "%")
    return _with_unit(digits(100.0 * fraction, significant), "%") if is_number(fraction) else NONE


def half_width(value: Any, low: Any, high: Any) -> str:
    """Half the interval in per cent of the value: "± 0.66 %"."""
    if not (is_number(value) and is_number(low) and is_number(high)) or value == 0:
        return NONE
    return f"±\u00a0{percent(0.5 * (high - low) / abs(value))}"


def deviation(value: Any, reference: Any, low: Any = None, high: Any = None) -> str:
    """How far a value is from a reference, in per cent of the reference, signed; as fine as its interval, or 0.1 %."""
    if not (is_number(value) and is_number(reference)) or reference == 0:
        return NONE
    percents = 100.0 / abs(reference)
    places = 1
    if is_number(low) and is_number(high) and high > low:
        places = min(places, _places(0.5 * (high - low) * percents))
    text = f"{percents * (value - reference):+.{places}f}".replace("-", "−")
    return _with_unit(text if text.strip("+−0.") else text[1:], "%")


def _prefix(value: Any, unit: str) -> tuple[float, str]:
    factor, shown = 1.0, _PRETTY.get(unit, unit)
    for below, new_factor, new_unit in _PREFIXES.get(unit, ()):
        if is_number(value) and 0.0 < abs(value) < below:
            factor, shown = new_factor, new_unit
    return factor, shown


def _superscript(number: int) -> str:
    return str(number).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))

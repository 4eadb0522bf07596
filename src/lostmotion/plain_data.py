"""Values out of JSON, TOML and .npz headers: each of the type that it must have, or an error that says where."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidInput

_REMEDY = "Correct it; what a program wrote is best written again."

_short = reprlib.Repr()
_short.maxlevel, _short.maxstring, _short.maxother = 3, 60, 60
_short.maxlist = _short.maxtuple = _short.maxdict = 6


def shown(value: object) -> str:
    """The value's repr, shortened: what a file holds may be of any size."""
    try:
        return _short.repr(value)
    except ValueError:  # Python writes no whole number of more than 4300 digits
        return "a number of thousands of digits"


def mapping(where: str, value: object) -> dict[str, Any]:
    """A mapping with texts as keys, whichever."""
    if not isinstance(value, Mapping) or not all(isinstance(key, str) for key in value):
        raise InvalidInput(where, shown(value), "a table", _REMEDY)
    return dict(value)


def table(where: str, value: object, needed: Iterable[str], optional: Iterable[str] = ()) -> dict[str, Any]:
    """A mapping that holds all needed keys, and no others but the optional ones."""
    needed, found = set(needed), mapping(where, value)
    missing, unknown = sorted(needed - set(found)), sorted(set(found) - needed - set(optional))
    if missing or unknown:
        parts = [f"without {', '.join(missing)}"] * bool(missing) + [f"with {shown(unknown)}"] * bool(unknown)
        raise InvalidInput(
            where, "a table " + " and ".join(parts), "the keys " + ", ".join(sorted(needed)), _REMEDY
        )
    return found


def entries(where: str, value: object) -> list[Any]:
    """A list (or a tuple)."""
    if not isinstance(value, list | tuple):
        raise InvalidInput(where, shown(value), "a list", _REMEDY)
    return list(value)


def text(where: str, value: object) -> str:
    if not isinstance(value, str):
        raise InvalidInput(where, shown(value), "a text", _REMEDY)
    return value


def texts(where: str, value: object) -> tuple[str, ...]:
    """A list of texts."""
    return tuple(text(f"{where}[{i}]", entry) for i, entry in enumerate(entries(where, value)))


def flag(where: str, value: object) -> bool:
    if not isinstance(value, bool):
        raise InvalidInput(where, shown(value), "true or false", _REMEDY)
    return value


def whole(where: str, value: object) -> int:
    """A whole number that 64 bits hold."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or abs(int(value)) >= 2**63:
        raise InvalidInput(where, shown(value), "a whole number below 2⁶³", _REMEDY)
    return int(value)


def seed_of(where: str, value: object) -> int:
    """A seed: numpy takes none below zero."""
    found = whole(where, value)
    if found < 0:
        raise InvalidInput(where, shown(value), "a whole number from 0 on", "Leave out the sign.")
    return found


def number(where: str, value: object) -> float:
    """A finite number; no text and no bool, which ``float`` would take."""
    if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        try:
            found = float(value)
        except OverflowError:  # a whole number beyond 1e308
            found = math.inf
        if math.isfinite(found):
            return found
    raise InvalidInput(where, shown(value), "a finite number", _REMEDY)


def numbers(where: str, value: object, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Nested lists (or an array) of finite numbers as an array of that shape.

    Without elements, the lists may have lost dimensions: a (0, 3) array is written as [].
    """
    try:
        array = np.asarray(value)
    except (ValueError, OverflowError):  # lists of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "fiu" or (array.shape != shape and not array.size == math.prod(shape) == 0):
        kind = f"shape {array.shape}" if array.dtype.kind in "fiu" else shown(value)
        raise InvalidInput(where, kind, f"numbers of shape {shape}", _REMEDY)
    if not np.all(np.isfinite(array)):
        raise InvalidInput(where, "NaN or infinity", "finite numbers", _REMEDY)
    return array.astype(np.float64).reshape(shape)

"""Checks of names, sample time and numbers that both kinds of law share."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidInput
from ..plain_data import number, shown
from .inputs import Matrix

#: The law reports replaced inputs as bits of one number, also on a 32-bit target (layout).
MAX_INPUTS = 31


def check_names(where: str, names: tuple[str, ...]) -> None:
    if not all(isinstance(n, str) and n for n in names):
        raise InvalidInput(where, shown(names), "non-empty names", "Name them all.")
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise InvalidInput(where, shown(names), "names without doubles", f"Rename {shown(twice)}.")


def sample_time(where: str, value: float) -> float:
    """A positive sample time, s."""
    dt = number(where, value)
    if not dt > 0.0:
        raise InvalidInput(where, repr(value), "a positive sample time in s", "Check the unit.")
    return dt


def matrix_of(where: str, values: ArrayLike, shape: tuple[int, ...]) -> Matrix:
    """A read-only copy of the given shape; an empty array gives zeros."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(where, shown(values), f"numbers of shape {shape}", "Give an array.") from None
    if array.size == 0:
        array = np.zeros(shape)
    if array.shape != shape:
        raise InvalidInput(
            where, f"shape {array.shape}", f"shape {shape}", "Count states, inputs, outputs, curves."
        )
    if not np.all(np.isfinite(array)):
        raise InvalidInput(where, "NaN or infinity", "finite numbers", "Check what it was computed from.")
    array.setflags(write=False)
    return array

"""Checks of numbers that all parts of a drivetrain share."""

from __future__ import annotations

import math

from ..errors import InvalidInput


def not_negative(where: str, value: float, positive: bool = False) -> float:
    """`value` as a float, or InvalidInput if it is negative, not finite, or zero where it must be positive."""
    value = float(value)
    if not math.isfinite(value) or value < 0.0 or (positive and value == 0.0):
        expected = "a positive number" if positive else "zero or a positive number"
        raise InvalidInput(where, repr(value), f"{expected} in SI units", "Check the sign and the unit.")
    return value

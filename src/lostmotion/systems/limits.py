"""Smaller and larger of two signals, and a limited rate of change, as laws."""

from __future__ import annotations

import math

import numpy as np

from ..argument_checks import checks_arguments
from ..curves import PiecewiseLinear, saturation
from ..errors import InvalidInput
from .discrete_system import DiscreteSystem

#: max(z, 0): the curve of which both selections are made (numerics).
POSITIVE_PART = PiecewiseLinear(((0.0, 0.0),), 0.0, 1.0)


@checks_arguments
def minimum(first: str, second: str, output: str, dt: float) -> DiscreteSystem:
    """``output`` = min(first, second) = first − max(first − second, 0); exact to the rounding of the difference."""
    return _selection(first, second, output, dt, "minimum", -1.0)


@checks_arguments
def maximum(first: str, second: str, output: str, dt: float) -> DiscreteSystem:
    """``output`` = max(first, second) = first + max(second − first, 0); exact to the rounding of the difference."""
    return _selection(first, second, output, dt, "maximum", 1.0)


def _selection(first: str, second: str, output: str, dt: float, kind: str, sign: float) -> DiscreteSystem:
    return DiscreteSystem(
        inputs=(first, second), outputs=(output,), dt=dt, name=f"{kind} of {first} and {second}",
        curves=(POSITIVE_PART,), G=sign * np.array([[-1.0, 1.0]]), D=np.eye(1, 2), J=np.full((1, 1), sign),
    )  # fmt: skip


@checks_arguments
def rate_limit(signal: str, output: str, *, rate: float, dt: float, start: float = 0.0) -> DiscreteSystem:
    """``output`` follows ``signal`` by at most ``rate`` (its unit per s): y = y₋₁ + clip(u − y₋₁, ±rate·dt).

    Parameters
    ----------
    signal, output : str
    rate : float, unit of the signal per s
    dt : float, s
    start : float
        Output before the first sample, in the signal's unit.

    Raises
    ------
    InvalidInput
        If the rate is not a positive number.
    """
    if not (math.isfinite(rate) and rate > 0.0):
        raise InvalidInput(
            "rate_limit.rate",
            repr(rate),
            "a positive number in the signal's unit per s",
            "Leave the limit out.",
        )
    one = np.ones((1, 1))
    return DiscreteSystem(
        inputs=(signal,), outputs=(output,), states=(f"{output}_last",), dt=dt, name=f"rate limit of {signal}",
        curves=(saturation(rate * dt),), F=-one, G=one, C=one, J=one, A=one, E=one,
        initial_state=np.array([start]),
    )  # fmt: skip

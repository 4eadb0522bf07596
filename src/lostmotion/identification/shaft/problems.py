"""Warnings of the shaft measurements: values not identified, and the remedy."""

from __future__ import annotations

from ...errors import Problem
from ..statistics.estimates import Interval


def gap_in_stiffness(torque: str) -> Problem:
    return Problem(
        "warning",
        f"shaft_stiffness: {torque}",
        "a torque that reverses",
        "a torque of one sign",
        "If the shaft has a gap, it lowers the measured stiffness: choose a window of one sign.",
    )


def too_little(
    torque: str, segments: int, usable: int, length: float, least: tuple[int, int], min_coherence: float
) -> Problem:
    """``length`` of a segment, s; ``least``: segments and usable frequencies that are needed."""
    return Problem(
        "warning",
        f"shaft_stiffness: {torque}",
        f"{segments} segments of {length:.3g} s, {usable} frequencies of coherence ≥ {min_coherence:g}",
        f"at least {least[0]} segments and {least[1]} frequencies",
        "Record longer or excite the shaft more within the band; the stiffness is not excited.",
    )


def may_be_zero(torque: str, stiffness: Interval) -> Problem:
    return Problem(
        "warning",
        f"shaft_stiffness: {torque}",
        f"a 95 % interval of {stiffness[0]:.3g} … {stiffness[1]:.3g} Nm/rad",
        "an interval of positive stiffness",
        "Excite the shaft more often than once, over the whole band; the stiffness is not excited.",
    )


def wrong_sign(torque: str) -> Problem:
    return Problem(
        "warning",
        f"shaft_stiffness: {torque}",
        "torque and twist of opposite sign",
        "a positive torque that drives end b",
        "Give the torque the sign −1, or exchange the speeds; the stiffness is shown as if that were done.",
    )


def no_ring_down(signal: str, got: str) -> Problem:
    return Problem(
        "warning",
        f"ring_down: {signal}",
        got,
        "a step after which the signal rings down, ten periods long",
        "Record a sharp step of load or torque and let it ring; widen the band if the eigenfrequency lies outside.",
    )

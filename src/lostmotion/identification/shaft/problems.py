"""Warnings of the shaft measurements: values not identified, and the remedy."""

from __future__ import annotations

from ...errors import Problem
from ..statistics.estimates import Interval


def gap_in_stiffness(torque: str) -> Problem:
    where = f"shaft_stiffness: {torque}"
    remedy = "If the shaft has a gap, it lowers the measured stiffness: choose a window of one sign."
    return Problem.warning(where, "a torque that reverses", "a torque of one sign", remedy)


def too_little(
    torque: str, segments: int, usable: int, length: float, least: tuple[int, int], min_coherence: float
) -> Problem:
    """``length`` of a segment, s; ``least``: segments and usable frequencies that are needed."""
    got = f"{segments} segments of {length:.3g} s, {usable} frequencies of coherence ≥ {min_coherence:g}"
    expected = f"at least {least[0]} segments and {least[1]} frequencies"
    remedy = "Record longer or excite the shaft more within the band; the stiffness is not excited."
    return Problem.warning(f"shaft_stiffness: {torque}", got, expected, remedy)


def may_be_zero(torque: str, stiffness: Interval) -> Problem:
    got = f"a 95 % interval of {stiffness[0]:.3g} … {stiffness[1]:.3g} Nm/rad"
    remedy = "Excite the shaft more often than once, over the whole band; the stiffness is not excited."
    return Problem.warning(f"shaft_stiffness: {torque}", got, "an interval of positive stiffness", remedy)


def negative_inertia(torque: str, inertia: Interval) -> Problem:
    got = f"a stiffness that rises with frequency, as by an inertia of {inertia[0]:.2g} … {inertia[1]:.2g} kg m2"
    remedy = (
        "The torque is no torque of the shaft between the speeds, or filtered otherwise: check the channels."
    )
    return Problem.warning(
        f"shaft_stiffness: {torque}", got, "an inertia between the sensors, or none", remedy
    )


def wrong_sign(torque: str) -> Problem:
    got = "torque and twist of opposite sign"
    expected = "a positive torque that drives end b"
    remedy = (
        "Give the torque the sign −1, or exchange the speeds; the stiffness is shown as if that were done."
    )
    return Problem.warning(f"shaft_stiffness: {torque}", got, expected, remedy)


def no_ring_down(signal: str, got: str) -> Problem:
    expected = "a step after which the signal rings down, ten periods long"
    remedy = "Record a sharp step of load or torque and let it ring; widen the band if the eigenfrequency lies outside."
    return Problem.warning(f"ring_down: {signal}", got, expected, remedy)

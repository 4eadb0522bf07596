"""Warnings of the friction tests: values that cannot be identified, and the remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...errors import Problem
from ..statistics.estimates import Interval


def commanded_torque(torque: str, measured: str) -> Problem:
    return Problem(
        "warning",
        f"friction: {torque}",
        "a commanded torque",
        f"the measured one, {measured}, which is in the recording",
        f'Leave the argument out, or give torque="{measured}": losses and errors of the current '
        "controller would count as friction and inertia.",
    )


def inertia_not_identified(where: str, value: float, margin: float) -> Problem:
    return Problem(
        "warning",
        f"{where}: inertia",
        f"{value:.3g} ± {margin:.2g} kg m2 (95 %)",
        "an interval of positive inertia",
        "Record a motion that accelerates, or give the inertia; the friction is identified anyway.",
    )


def scale_not_identified(torque: str) -> Problem:
    return Problem(
        "warning",
        f"torque_step: {torque}",
        "one constant torque while the drive turns, and no inertia",
        "the inertia, or torques that differ",
        "Give the inertia, or record two levels of torque or the coasting down as well: one level gives "
        "friction per inertia only.",
    )


def does_not_turn(speed: str, averages: int, needed: int, largest: float) -> Problem:
    return Problem(
        "warning",
        f"torque_step: {speed}",
        f"{averages} averages while it turns (largest speed {largest:.3g} rad/s)",
        f"at least {needed}: a drive that turns for some seconds",
        "Apply a torque above the breakaway level, record longer, or shorten the averages.",
    )


def may_be_zero(values: Mapping[str, float | None], intervals: Mapping[str, Interval]) -> Problem:
    """One warning for all friction values whose intervals contain zero."""
    got = ", ".join(f"{n} {values[n]:.2g} ({low:.2g} … {high:.2g})" for n, (low, high) in intervals.items())
    return Problem(
        "warning",
        "torque_step",
        f"intervals that contain zero: {got}",
        "friction that differs from zero",
        "Record longer, up to the final speed, with two levels of torque, to separate Coulomb and viscous friction.",
    )


def unsteady_plateaus(speeds: Sequence[float]) -> Problem:
    return Problem(
        "warning",
        "friction_ladder",
        "speed that scatters by more than 30 % at " + ", ".join(f"{w:.3g}" for w in speeds) + " rad/s",
        "plateaus at constant speed",
        "They are left out. A stiffer speed controller lowers the speed at which the drive slips and sticks.",
    )


def too_few_plateaus(count: int) -> Problem:
    return Problem(
        "warning",
        "friction_ladder",
        f"{count} steady plateaus",
        "more plateaus than parameters: six or more, with two below and two above the Stribeck speed",
        "Record more speeds.",
    )


def one_ramp(name: str) -> Problem:
    return Problem(
        "warning",
        name,
        "one ramp",
        "three or more in that direction",
        "Repeat the ramp: the interval contains the uncertainty of the instant, not the scatter of the level.",
    )


def never_moved(angle: str, at_rest: float, rest: float) -> Problem:
    """``at_rest``: largest torque without motion, Nm; ``rest``: time at rest needed before a start, s."""
    return Problem(
        "warning",
        f"breakaway: {angle}",
        f"no start from rest, up to {at_rest:.3g} Nm",
        f"{rest} s of rest under a torque that rises until the drive moves",
        "Raise the ramp's end, start it from rest, and let it rise more slowly.",
    )

"""Warnings of the friction tests: values that cannot be identified, and the remedy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...errors import Problem
from ..statistics.estimates import Interval


def commanded_torque(torque: str, measured: str) -> Problem:
    expected = f"the measured one, {measured}, which is in the recording"
    remedy = (
        f'Leave the argument out, or give torque="{measured}": losses and errors of the current '
        "controller would count as friction and inertia."
    )
    return Problem.warning(f"friction: {torque}", "a commanded torque", expected, remedy)


def inertia_not_identified(where: str, value: float, margin: float) -> Problem:
    got = f"{value:.3g} ± {margin:.2g} kg m2 (95 %)"
    remedy = "Record a motion that accelerates, or give the inertia; the friction is identified anyway."
    return Problem.warning(f"{where}: inertia", got, "an interval of positive inertia", remedy)


def scale_not_identified(torque: str) -> Problem:
    got = "one constant torque while the drive turns, and no inertia"
    remedy = (
        "Give the inertia, or record two levels of torque or the coasting down as well: one level gives "
        "friction per inertia only."
    )
    return Problem.warning(f"torque_step: {torque}", got, "the inertia, or torques that differ", remedy)


def does_not_turn(speed: str, averages: int, needed: int, largest: float) -> Problem:
    got = f"{averages} averages while it turns (largest speed {largest:.3g} rad/s)"
    expected = f"at least {needed}: a drive that turns for some seconds"
    remedy = "Apply a torque above the breakaway level, record longer, or shorten the averages."
    return Problem.warning(f"torque_step: {speed}", got, expected, remedy)


def may_be_zero(values: Mapping[str, float | None], intervals: Mapping[str, Interval]) -> Problem:
    """One warning for all friction values whose intervals contain zero."""
    texts = (f"{n} {values[n]:.2g} ({low:.2g} … {high:.2g})" for n, (low, high) in intervals.items())
    got = f"intervals that contain zero: {', '.join(texts)}"
    remedy = (
        "Record longer, up to the final speed, with two levels of torque, to separate Coulomb and viscous "
        "friction."
    )
    return Problem.warning("torque_step", got, "friction that differs from zero", remedy)


def unsteady_plateaus(speeds: Sequence[float]) -> Problem:
    got = "speed that scatters by more than 30 % at " + ", ".join(f"{w:.3g}" for w in speeds) + " rad/s"
    remedy = (
        "They are left out. A stiffer speed controller lowers the speed at which the drive slips and sticks."
    )
    return Problem.warning("friction_ladder", got, "plateaus at constant speed", remedy)


def too_few_plateaus(count: int, stribeck: bool) -> Problem:
    expected = "more plateaus than parameters: six or more, with two below and two above the Stribeck speed"
    if not stribeck:
        expected = "more plateaus than parameters: four or more"
    return Problem.warning("friction_ladder", f"{count} steady plateaus", expected, "Record more speeds.")


def one_ramp(name: str) -> Problem:
    remedy = (
        "Repeat the ramp: the interval contains the uncertainty of the instant, not the scatter of the level."
    )
    return Problem.warning(name, "one ramp", "three or more in that direction", remedy)


def never_moved(angle: str, at_rest: float, rest: float) -> Problem:
    """``at_rest``: largest torque without motion, Nm; ``rest``: time at rest needed before a start, s."""
    got = f"no start from rest, up to {at_rest:.3g} Nm"
    expected = f"{rest} s of rest under a torque that rises until the drive moves"
    remedy = "Raise the ramp's end, start it from rest, and let it rise more slowly."
    return Problem.warning(f"breakaway: {angle}", got, expected, remedy)

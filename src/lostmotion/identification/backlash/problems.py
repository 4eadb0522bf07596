"""Warnings of the backlash tests (load locked, two encoders, shaft torque): values not identified, and the remedy."""

from __future__ import annotations

import numpy as np

from ...errors import Problem
from ..friction.result import Floats
from ..statistics.estimates import Interval

#: Fewest rows on each side of the gap (numerics: five for each of the fit's four columns).
MIN_ROWS = 20
#: The motor must turn by this many counts for a result (numerics: each end is known to one count only).
MIN_COUNTS = 3.0
#: Fewest ramps for an interval without a warning (option: Student's factor of their scatter is 3.2 then).
MIN_RAMPS = 4


def not_excited(m: Floats, theta: Floats, count: float, torque: str) -> Problem | None:
    largest, turned = float(np.abs(m).max()), float(np.ptp(theta))
    if not (m.min() < 0.0 < m.max()):
        got = f"{m.min():.4g} … {m.max():.4g} Nm: it never reverses"
        remedy = "Ramp the torque through zero; the backlash is not excited."
        return Problem.warning(f"locked_backlash: {torque}", got, "a torque of both signs", remedy)
    if turned < max(MIN_COUNTS * count, 1e-12):
        got = f"up to {largest:.3g} Nm, under which the motor turns by {turned:.3g} rad ({_counts(turned, count)})"
        expected = f"a torque that moves the motor across the gap, {MIN_COUNTS:g} counts or more"
        remedy = (
            "Raise the torque above the friction at the motor, or use a finer encoder: too small to cross."
        )
        return Problem.warning(f"locked_backlash: {torque}", got, expected, remedy)
    return None


def _counts(turned: float, count: float) -> str:
    return f"{turned / count:.1f} counts" if count > 0.0 else "no count"


def no_rows(torque: str, settling: float) -> Problem:
    got = f"fewer than {MIN_ROWS} samples at rest on one flank"
    expected = f"a torque that stays on each side of zero for much longer than {settling:g} s, and exceeds the friction"
    remedy = (
        "Ramp more slowly (fast sines bounce from flank to flank), or raise the torque: too small to cross."
    )
    return Problem.warning(f"locked_backlash: {torque}", got, expected, remedy)


def stiffness_open(low: float, high: float) -> Problem:
    got = (
        f"one edge of a count on each flank: any stiffness from {low:.3g} Nm/rad on is compatible, up to {high:.3g} "
        "if the wind-up covers one count as assumed"
    )
    expected = "a wind-up that covers two counts or more"
    remedy = (
        "Raise the torque, use a finer encoder, or lock the load at another angle; the interval of the backlash "
        "contains this uncertainty."
    )
    return Problem.warning("locked_backlash: stiffness", got, expected, remedy)


def one_way() -> Problem:
    expected = "rising and falling torque on at least one flank"
    remedy = (
        "Ramp back to zero as well: friction at the motor is not identified here, and the backlash reads "
        "2·friction/stiffness too small."
    )
    return Problem.warning("locked_backlash", "each flank loaded in one direction only", expected, remedy)


def few_ramps(count: int) -> Problem:
    remedy = "Repeat them: the interval comes from their scatter."
    return Problem.warning("locked_backlash", f"{count} ramps", f"{MIN_RAMPS} or more", remedy)


def none_found(most: float) -> Problem:
    got = f"an interval that contains zero: no backlash found, at most {max(most, 0.0):.3g} rad"
    remedy = (
        "If there should be one, check that the load is locked behind it and that the torque overcomes its "
        "friction."
    )
    return Problem.warning("locked_backlash", got, "a gap that differs from zero", remedy)


def no_torque() -> Problem:
    remedy = "Record it: wind-up, hysteresis and dead zone cannot be separated without one."
    return Problem.warning("lost_motion", "no torque", "torque_shaft or torque_motor", remedy)


def hardly_reverses(torque: str, m: Floats, reversals: int, needed: int) -> Problem:
    got = f"{m.min():.4g} … {m.max():.4g} Nm with {reversals} reversals: a dead zone is not excited"
    remedy = "Record motions in which the torque changes its sign; gravity may hold the flanks together."
    return Problem.warning(f"lost_motion: {torque}", got, f"{needed} reversals of the torque or more", remedy)


def none_reported(found: Interval, claim: float) -> Problem:
    """``claim``: the jump must be this many times the twist's scatter."""
    got = f"{found[0]:.2g} … {found[1]:.2g} rad (95 %): no dead zone is reported"
    expected = (
        f"an interval above zero, with and without rising stiffness, and a jump of {claim:g} times the twist's "
        "scatter"
    )
    remedy = "If there should be one, record slower motions with more reversals of the torque."
    return Problem.warning("lost_motion: backlash", got, expected, remedy)


def no_shaft_torque(signal: str) -> Problem:
    expected = "a measured or estimated shaft torque"
    remedy = "Without it, whether the gap is crossed is left to the identification from motor torque."
    return Problem.warning(f"backlash_excited: {signal}", "no such signal", expected, remedy)


def never_reverses(torque: str, low: float, high: float) -> Problem:
    got = f"{low:.4g} … {high:.4g} Nm: it never reverses, so the backlash is not excited"
    remedy = "Record reversals of the torque; until then the backlash stays as given, or unknown."
    return Problem.warning(f"backlash: {torque}", got, "a shaft torque that changes its sign", remedy)

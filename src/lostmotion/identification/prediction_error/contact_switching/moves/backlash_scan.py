"""Whether another backlash does better: the cost has many minima over it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..filter import INDEX, LAWS, ContactFilter, pole_of
from ..likelihood import FITTED_LEVEL, Box, Candidate, cost_of, descend, polish, rates_first, side_by_side
from ..starts.from_drivetrain import unknown

Array = NDArray[np.float64]

#: Backlash over the wind-up at the torque's standard deviation (numerics: from one that does not show to a wide gap).
SCAN = tuple(np.geomspace(0.01, 30.0, 14))
#: Steps from each (numerics).
STEPS = 3
#: Logarithms of the sizes of a fine scan over a fit's, and how many minima of it are followed (numerics: over many rows
#: the minima are a few percent wide).
NEARBY, FOLLOWED = np.linspace(-np.log(4.0), np.log(4.0), 61), 4
#: A fine scan of all sizes, and how many minima of it are followed under each law of the contact (numerics).
FINE, UNDER_EACH = tuple(np.geomspace(SCAN[0], SCAN[-1], 160)), 2
#: Of a scan afresh: damping ratio, first noise level over the motion's own, steps at each level (numerics: hardly
#: damped; near enough to the sensor's that what the scan has found is not left).
LIGHT, LOW, STEPS_DOWN = 0.003, 0.1 * FITTED_LEVEL, 6


def with_other_backlash(found: Sequence[Candidate], box: Box) -> list[Candidate]:
    """Each candidate with a backlash of any size, a few steps from there; without those that have no gap to fit."""

    def moved(one: Candidate, gap: float) -> Candidate:
        return rates_first(replace(one, theta=_with_gap(one.theta, one.flt, gap)), box, STEPS)

    pairs = [(one, gap) for one in found if INDEX["backlash"] in one.free for gap in SCAN]
    return side_by_side(lambda pair: moved(*pair), pairs)


def with_better_backlash(found: Candidate, box: Box) -> list[Candidate]:
    """The candidate with backlashes up to four times its own either way, where it predicts better after a few steps.

    A crossing of the gap that takes a little longer comes rows later: over the backlash the cost has narrow minima, and
    no descent leads from one to the next.
    """
    place = INDEX["backlash"]
    if place not in found.free:
        return []

    def moved(step: float) -> Candidate:
        theta = found.theta.copy()
        theta[place] += step
        return replace(found, theta=theta, cost=found.flt.run(theta).cost)

    scanned = side_by_side(moved, list(map(float, NEARBY)))
    own = NEARBY.size // 2
    few = [i for i in _minima(scanned) if abs(i - own) > 1][:FOLLOWED]
    moved_on = side_by_side(lambda i: rates_first(scanned[i], box, STEPS), few)
    return [one for one in moved_on if one.cost < found.cost]


def with_best_backlash(
    found: Candidate, rows: ContactFilter, box: Box, free: Collection[int] = (), afresh: bool = False
) -> Candidate:
    """The candidate with the backlash of any size, and under any law of the contact, that predicts best after a few
    steps; the scan is over some rows. ``free``: what a candidate without a gap gets with one.

    In a wrong minimum, damping and the rates of unknown torques are often so large that no gap shows. ``afresh``: with
    little damping and the rates of a start; then what the scan finds comes down through the noise levels.
    """
    at = replace(found.over(rows), level=found.flt.level)
    theta = _ringing(found) if afresh else found.theta
    begun = replace(found, free=sorted({*found.free, *free, INDEX["backlash"]}))

    def moved(law: str, gap: float) -> Candidate:
        tried = _with_gap(theta, found.flt, gap)
        cost = replace(at, law=law).run(tried).cost
        return replace(begun, theta=tried, cost=cost, flt=replace(found.flt, law=law))

    def lowest(law: str) -> list[Candidate]:
        scanned = [moved(law, gap) for gap in FINE]
        return [scanned[i] for i in _minima(scanned)[:UNDER_EACH]]

    def followed(one: Candidate) -> Candidate:
        if not afresh:
            return rates_first(one, box, STEPS)
        low = descend(one.start, replace(one.flt, charged=False), one.theta, one.free, box, LOW, STEPS_DOWN)
        return polish(replace(one, theta=low.theta, flt=replace(one.flt, level=low.flt.level)), one.flt, box)

    few = [one for each in side_by_side(lowest, list(LAWS)) for one in each]
    return min([found, *side_by_side(followed, few)], key=cost_of)


def _with_gap(theta: Array, flt: ContactFilter, gap: float) -> Array:
    """θ with another backlash, over the wind-up at the torque's standard deviation."""
    other = theta.copy()
    other[INDEX["backlash"]] = np.log(gap * flt.torque_deviation) - theta[INDEX["stiffness"]]
    return other


def _ringing(one: Candidate) -> Array:
    """θ with little damping, where that is fitted, and with the rates of a start."""
    pole = pole_of(one.theta)
    afresh = {
        name: rate for name, rate in unknown(one.flt, 2.0 * np.pi * pole).items() if name != "torque_rate"
    }
    if INDEX["damping"] in one.free:
        afresh["damping"] = LIGHT * one.values["stiffness"] / (np.pi * pole)
    return one.flt.changed(one.theta, **afresh)


def _minima(scanned: Sequence[Candidate]) -> list[int]:
    """Which have a lower cost than those beside them, the lowest first."""
    costs = [one.cost for one in scanned]
    inner = range(1, len(costs) - 1)
    return sorted((i for i in inner if costs[i] < min(costs[i - 1], costs[i + 1])), key=lambda i: costs[i])

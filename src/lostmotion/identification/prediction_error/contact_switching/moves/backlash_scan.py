"""Whether another backlash does better: the cost has many minima over it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..filter import LAWS, ContactFilter
from ..likelihood import FITTED_LEVEL, Box, Candidate, cost_of, descend, rates_first, side_by_side
from ..parameter_vector import INDEX, pole_of
from ..starts.from_drivetrain import unknown

Array = NDArray[np.float64]

#: Backlash over the wind-up at the torque's standard deviation (numerics: from one that does not show to a wide gap).
SIZES = np.geomspace(0.01, 30.0, 160)
#: Step of the finest part of a scan over a fit's own backlash, in the logarithm (numerics: half of the width of the
#: minima of a gap of many wind-ups).
FINE = 0.005
#: Logarithms of the sizes of such a scan (numerics: over many rows the minima of other gaps are a few percent wide).
NEARBY = np.union1d(np.linspace(-np.log(4.0), np.log(4.0), 61), FINE * np.arange(-24, 25))
#: How many minima of a scan are followed, of one under each law of the contact, and steps from each (numerics).
FOLLOWED, UNDER_EACH, STEPS = 4, 2, 3
#: Of a scan afresh: damping ratio, first noise level over the motion's own, steps at each level (numerics: hardly
#: damped; near enough to the sensor's that what the scan has found is not left).
LIGHT, LOW, STEPS_DOWN = 0.003, 0.1 * FITTED_LEVEL, 6


def with_other_backlash(found: Sequence[Candidate], box: Box) -> list[Candidate]:
    """Each candidate with backlashes of any size, a few steps from there; without those that have no gap to fit."""
    with_gap = [one for one in found if INDEX["backlash"] in one.free]
    few = [each for one in with_gap for each in _minima(one, _any_size(one), one.flt)[:FOLLOWED]]
    return side_by_side(lambda one: rates_first(one, box, STEPS), few)


def with_better_backlash(found: Candidate, box: Box) -> list[Candidate]:
    """The candidate with backlashes up to four times its own either way, where it predicts better after a few steps.

    A crossing of the gap that takes a little longer comes rows later: over the backlash the cost has narrow minima, and
    no descent leads from one to the next.
    """
    place = INDEX["backlash"]
    if place not in found.free:
        return []
    own, beside = found.theta[place], 1.5 * FINE
    others = [one for one in _minima(found, own + NEARBY, found.flt) if abs(one.theta[place] - own) > beside]
    moved_on = side_by_side(lambda one: rates_first(one, box, STEPS), others[:FOLLOWED])
    return [one for one in moved_on if one.cost < found.cost]


def with_best_backlashes(
    found: Candidate,
    rows: ContactFilter,
    box: Box,
    free: Collection[int] = (),
    afresh: bool = False,
    laws: Collection[str] = tuple(LAWS),
) -> list[Candidate]:
    """The candidate with the backlashes of any size, and under any of some laws of the contact, that predict best after
    a few steps, the lowest first; the scan is over some rows. ``free``: what a candidate without a gap gets with one.

    In a wrong minimum, damping and the rates of unknown torques are often so large that no gap shows. ``afresh``: with
    little damping and the rates of a start; then what the scan finds comes down through the noise levels.
    """
    at = replace(found.over(rows), level=found.flt.level)
    begun = replace(found, free=sorted({*found.free, *free, INDEX["backlash"]}))
    begun = replace(begun, theta=_ringing(found)) if afresh else begun

    def lowest(law: str) -> list[Candidate]:
        under = replace(begun, flt=replace(found.flt, law=law))
        return _minima(under, _any_size(found), replace(at, law=law))[:UNDER_EACH]

    def followed(one: Candidate) -> Candidate:
        if afresh:
            low = descend(
                one.start, replace(one.flt, charged=False), one.theta, one.free, box, LOW, STEPS_DOWN
            )
            one = replace(one, theta=low.theta, flt=replace(one.flt, level=low.flt.level))
        return rates_first(one, box, STEPS)

    few = [one for law in laws for one in lowest(law)]
    return sorted(side_by_side(followed, few), key=cost_of)


def _any_size(one: Candidate) -> Array:
    """Logarithms of backlashes (rad)."""
    return np.asarray(np.log(SIZES * one.flt.torque_deviation) - one.theta[INDEX["stiffness"]])


def _minima(one: Candidate, backlashes: Array, rows: ContactFilter) -> list[Candidate]:
    """The candidate with those backlashes that predict some rows better than their neighbours, the lowest first."""

    def moved(backlash: float) -> Candidate:
        theta = one.theta.copy()
        theta[INDEX["backlash"]] = backlash
        return replace(one, theta=theta, cost=rows.run(theta).cost)

    scanned = side_by_side(moved, list(map(float, backlashes)))
    neighbours = zip(scanned, scanned[1:], scanned[2:], strict=False)
    return sorted(
        (own for left, own, right in neighbours if own.cost < min(left.cost, right.cost)), key=cost_of
    )


def _ringing(one: Candidate) -> Array:
    """θ with little damping, where that is fitted, and with the rates of a start."""
    pole = pole_of(one.theta)
    afresh = {
        name: rate for name, rate in unknown(one.flt, 2.0 * np.pi * pole).items() if name != "torque_rate"
    }
    if INDEX["damping"] in one.free:
        afresh["damping"] = LIGHT * one.values["stiffness"] / (np.pi * pole)
    return one.flt.changed(one.theta, **afresh)

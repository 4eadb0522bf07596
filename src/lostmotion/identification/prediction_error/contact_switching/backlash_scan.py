"""Whether another backlash does better: the cost has many minima over it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from .filter import INDEX
from .likelihood import Box, Candidate, rates_first, side_by_side

#: Backlash over the wind-up at the torque's standard deviation (numerics: from one that does not show to a wide gap).
SCAN = tuple(np.geomspace(0.01, 30.0, 14))
#: Steps from each (numerics).
STEPS = 3
#: Logarithms of the sizes of a fine scan over a fit's, and how many minima of it are followed (numerics: over many rows
#: the minima are a few percent wide).
NEARBY, FOLLOWED = np.linspace(-np.log(4.0), np.log(4.0), 61), 4


def with_other_backlash(found: Sequence[Candidate], box: Box) -> list[Candidate]:
    """Each candidate with a backlash of any size, a few steps from there; without those that have no gap to fit."""
    place, stiffness = INDEX["backlash"], INDEX["stiffness"]

    def moved(one: Candidate, gap: float) -> Candidate:
        theta = one.theta.copy()
        theta[place] = np.log(gap * one.flt.torque_deviation) - theta[stiffness]
        return rates_first(replace(one, theta=theta), box, STEPS)

    pairs = [(one, gap) for one in found if place in one.free for gap in SCAN]
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
    costs = np.array([one.cost for one in scanned])
    own = NEARBY.size // 2
    lowest = [
        i
        for i in range(1, NEARBY.size - 1)
        if abs(i - own) > 1 and costs[i] < min(costs[i - 1], costs[i + 1])
    ]
    few = sorted(lowest, key=lambda i: float(costs[i]))[:FOLLOWED]
    moved_on = side_by_side(lambda i: rates_first(scanned[i], box, STEPS), few)
    return [one for one in moved_on if one.cost < found.cost]

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


def with_other_backlash(found: Sequence[Candidate], box: Box) -> list[Candidate]:
    """Each candidate with a backlash of any size, a few steps from there; without those that have no gap to fit."""
    place, stiffness = INDEX["backlash"], INDEX["stiffness"]

    def moved(one: Candidate, gap: float) -> Candidate:
        theta = one.theta.copy()
        theta[place] = np.log(gap * one.flt.torque_deviation) - theta[stiffness]
        return rates_first(replace(one, theta=theta), box, STEPS)

    pairs = [(one, gap) for one in found if place in one.free for gap in SCAN]
    return side_by_side(lambda pair: moved(*pair), pairs)

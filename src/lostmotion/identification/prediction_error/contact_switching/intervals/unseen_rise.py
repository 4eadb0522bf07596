"""What a friction that rises towards rest may change of the values where none was found."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..likelihood import Candidate, side_by_side
from ..parameter_vector import INDEX
from ..structures.rising_friction import ENDS
from ..told import told_vector
from .score_test import change_by, room_by_score

Array = NDArray[np.float64]

#: Rise over the Coulomb level at most (option: as much as the zoo's largest; not calibrated).
MOST = 0.5
#: Speeds over which it fades, over the speed's standard deviation (numerics: slower than is seen, and almost viscous).
FADES = (0.01, 0.03, 0.1, 0.3)
#: Rise whose effect stands for that of any other (numerics: far above rounding, and small).
SMALL = 0.01


def room_for_unseen_rise(best: Candidate) -> Array:
    """(8,) half widths, in the logarithm, for a rise at either end with friction that has none.

    Coulomb and viscous friction are the line closest to the curve at all speeds of the recording. A rise that the few
    rows at low speeds hardly show bends that line.
    """
    base = told_vector(best)

    def own(other: Candidate) -> Array:
        # A viscous friction may be none beside a rise; what is none without has no value that could change.
        line = told_vector(other, best.speeds)
        return np.where(np.isfinite(base), line, 0.0) - np.where(np.isfinite(base), base, 0.0)

    others = _rising(best)
    missing = zip(effects(best), (own(other) / SMALL for other in others), strict=True)
    return room_by_score(best, list(missing), MOST)


def effects(best: Candidate) -> list[Array]:
    """Change of the weighted innovations by a rise of 1 that fades at each of ``FADES``, at each end without one."""
    return side_by_side(lambda one: change_by(one.flt.run(one.theta), best.run) / SMALL, _rising(best))


def _rising(best: Candidate) -> list[Candidate]:
    """With such a rise, a small one."""
    found, values = [], best.values
    ends = [end for end in ENDS if values[f"coulomb{end}"] > 0.0 and not values[f"rise{end}"] > 0.0]
    for end, fade in product(ends, FADES):
        places = [INDEX[f"rise{end}"], INDEX[f"fade{end}"]]
        theta = best.theta.copy()
        theta[places] = SMALL, np.log(fade * best.flt.speed_deviation)
        found.append(replace(best, theta=theta, free=sorted({*best.free, *places})))
    return found

"""What a friction that rises towards rest may change of the values where none was found."""

from __future__ import annotations

from dataclasses import replace

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
    base, values = told_vector(best), best.values

    def missing(where: tuple[str, float]) -> tuple[Array, Array]:
        end, fade = where
        flt, names = best.flt, (f"rise{end}", f"fade{end}")
        theta = best.theta.copy()
        theta[[INDEX[name] for name in names]] = SMALL, np.log(fade * flt.speed_deviation)
        other = replace(best, theta=theta, free=sorted({*best.free, *(INDEX[name] for name in names)}))
        # A viscous friction may be none beside a rise; what is none without has no value that could change.
        own = np.where(np.isfinite(base), told_vector(other), 0.0) - np.where(np.isfinite(base), base, 0.0)
        return change_by(flt.run(theta), best.run) / SMALL, own / SMALL

    ends = [end for end in ENDS if values[f"coulomb{end}"] > 0.0 and not values[f"rise{end}"] > 0.0]
    return room_by_score(best, side_by_side(missing, [(end, fade) for end in ends for fade in FADES]), MOST)

"""Whether a candidate lacks nothing that the recording shows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..intervals import further_inertias, unseen_rise
from ..intervals.score_test import change_by, shows
from ..likelihood import Candidate, side_by_side
from ..moves.choices import under_other_laws
from ..structures.shaft_inertias import has_fourth

Array = NDArray[np.float64]


def lacks_nothing(best: Candidate) -> bool:
    """Whether its innovations show no other inertia, no rising friction, no other law of the contact, no torque that
    changes otherwise, and no other values in one half of the rows: a fit with one of these is no better.

    Each takes one pass of the filter or none, a fit some twenty with sensitivities.
    """
    drifting = replace(best, flt=replace(best.flt, drifts=not best.flt.drifts))
    others = [*under_other_laws(best), drifting]
    otherwise = side_by_side(lambda one: change_by(one.flt.run(one.theta), best.run), others)
    inertias = [] if has_fourth(best) else further_inertias.effects(best)
    return not shows(best, [*otherwise, *inertias, *unseen_rise.effects(best), *_halves(best)])


def _halves(best: Candidate) -> list[Array]:
    """Change of the weighted innovations by each parameter in the first half of the rows alone."""
    first = np.arange(best.run.weighted.size) < best.flt.rows // 2
    return [np.where(first, slopes, 0.0) for slopes in best.run.jacobian]

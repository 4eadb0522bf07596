"""Which rows of a recording tell most of a drive."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..estimate import CORE, scatter
from ..filter import ContactFilter
from ..likelihood import Candidate, side_by_side

#: Starts of the stretches that are compared, within the length of one (numerics).
OVERLAP = 2
#: Standard error of a logarithm from which on a value is not known at all (numerics).
UNKNOWN = 10.0


def most_telling(candidate: Candidate, flt: ContactFilter, rows: int) -> ContactFilter:
    """So many rows that follow each other: those in which chance leaves the candidate's inertias, stiffness and
    backlash least room.

    A lively motion need not cross the gap, nor excite the torsion: where the drive is roughly known, its sensitivities
    say which rows do.
    """
    lively = flt.liveliest(rows)
    if rows >= flt.rows:
        return lively
    starts = range(0, flt.rows - rows + 1, max(1, rows // OVERLAP))
    parts = [lively, *(flt.part(slice(first, first + rows)) for first in starts)]
    rooms = side_by_side(lambda part: _room(candidate, part), parts)
    return parts[int(np.argmin(rooms))]


def _room(candidate: Candidate, part: ContactFilter) -> float:
    """Sum of the logarithms of the standard errors of inertias, stiffness and, if it has one, backlash."""
    over = replace(candidate, flt=replace(candidate.over(part), level=candidate.flt.level))
    errors = np.fmin(scatter(over)[1][CORE], UNKNOWN)
    return float(np.sum(np.log(errors[errors > 0.0])))

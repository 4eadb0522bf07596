"""Which rows of a recording count: those after the filter has found the load, but for counts at a standstill."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...slow_motion.standstill import standstill

Array = NDArray[np.float64]

#: Torsional periods, at three times the nameplate's pole, from the first motion of a segment to the rows that count
#: (numerics: fifteen of the nameplate's; behind a wide gap the filter needs some contacts until it has found the load
#: and its torque), and of the shortest standstill (numerics: half of one; a drive that turns back rests for less).
SETTLED, STANDS = 45.0, 1.5
#: The noise of the sensor that is no motion, in standard deviations (numerics: less than one row in millions).
MOVED = 6.0
#: Part of a segment's rows that the filter may take to find the load at most (numerics).
LOST = 0.25


def moves(measured: Array, counted: bool, floor: float) -> NDArray[np.bool_]:
    """(n,) which rows of a segment are no standstill, as in ``ContactFilter``."""
    return np.abs(measured - measured[0] if counted else measured) > MOVED * floor


def counting_rows(
    measured: Array, counted: bool, floor: float, bounds: tuple[int, ...], settling: int
) -> NDArray[np.intp]:
    """Rows that count, of signals and with ``settling`` as in ``ContactFilter``; all after it if none of these moves.

    Counts do not change at a standstill, and their rounding is no noise: each such row is predicted exactly, and hides
    what is not explained of the others.
    """
    if not settling:
        return np.arange(measured.size)
    rows = []
    for first, end in pairwise(bounds):
        moving = moves(measured[first:end], counted, floor)
        begin = int(np.argmax(moving)) + settling if np.any(moving) else end
        rows.append(np.arange(first + min(begin, int(LOST * (end - first))), end))
    late = np.concatenate(rows)
    if not counted:
        return late
    rests = np.abs(np.diff(measured, prepend=measured[0])) < floor
    stands = standstill(rests, max(1, int(settling * STANDS / SETTLED)))
    return late if np.all(stands[late]) else late[~stands[late]]

"""Torque and speed of the longest segment of a recording, for what looks at a recording row by row."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..filter import ContactFilter

Array = NDArray[np.float64]


def longest_segment(flt: ContactFilter) -> tuple[Array, Array]:
    """Torque (n,), Nm, and speed (n,), rad/s; of counts over one row."""
    first, end = max(pairwise(flt.bounds), key=lambda segment: segment[1] - segment[0])
    measured = flt.measured[first:end]
    speed = np.diff(measured, prepend=measured[0]) / flt.dt if flt.counted else measured
    return flt.torque[first:end], speed

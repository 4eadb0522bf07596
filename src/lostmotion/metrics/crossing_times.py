"""When a sampled signal meets a level: straight lines between the samples."""

from __future__ import annotations

import numpy as np

from .arrays import Array

#: Band around the new set-point for the settling time, as a fraction of the step (option).
SETTLING_BAND = 0.02


def first_crossing(elapsed: Array, progress: Array, level: float) -> float | None:
    """First time at which progress reaches the level, ``None`` if never."""
    reached = np.flatnonzero(progress >= level)
    if reached.size == 0:
        return None
    i = int(reached[0])
    return float(elapsed[0]) if i == 0 else interpolate(elapsed, progress, i - 1, level)


def settling_time(elapsed: Array, distance: Array, band: float = SETTLING_BAND) -> float | None:
    """Last entry into the band; zero if the signal never leaves it, ``None`` if it ends outside."""
    outside = np.flatnonzero(distance > band)
    if outside.size == 0:
        return 0.0
    i = int(outside[-1])
    return None if i == distance.size - 1 else interpolate(elapsed, distance, i, band)


def interpolate(elapsed: Array, values: Array, i: int, level: float) -> float:
    """Time at which the straight line from sample i to i + 1 meets the level."""
    share = (level - values[i]) / (values[i + 1] - values[i])
    return float(elapsed[i] + share * (elapsed[i + 1] - elapsed[i]))

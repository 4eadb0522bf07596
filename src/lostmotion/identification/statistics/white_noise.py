"""The size of the white noise in a smooth signal."""

from __future__ import annotations

from math import comb

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Orders of differences (numerics: with seven rows in a period the third one of the motion may be 20 times the noise,
#: the 16th is none of it).
LEAST_ORDER, MOST_ORDER = 3, 16


def white_noise(values: Array) -> float:
    """Standard deviation of white noise in a smooth signal: from differences, by their median; of the order that sees
    least of the motion."""
    return min(
        float(np.median(np.abs(np.diff(values, order)))) / 0.6745 / np.sqrt(comb(2 * order, order))
        for order in range(LEAST_ORDER, MOST_ORDER + 1)
    )

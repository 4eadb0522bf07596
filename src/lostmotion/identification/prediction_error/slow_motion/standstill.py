"""Rows of a standstill: so slow for so long that the drive does not just turn back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def standstill(slow: NDArray[np.bool_], shortest: int) -> NDArray[np.bool_]:
    """(n,) which of the slow rows are in a stretch of so many at least."""
    stands, ends = slow.copy(), np.flatnonzero(np.diff(slow, prepend=False, append=False))
    for first, end in ends.reshape(-1, 2):
        stands[first:end] = end - first >= shortest
    return stands

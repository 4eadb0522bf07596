"""Whether differences have one sign: a permutation test."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def chance_of(rises: NDArray[np.float64]) -> float:
    """Chance of so large a sum if each rise were as likely a fall: the share of all choices of signs.

    A few that rise much do not hide that nearly all rise, as their deviation in Student's test would. Source: Fisher
    (1935), The design of experiments, section 21.
    """
    least = np.sum(rises) - 1e-9 * np.sum(np.abs(rises))
    # Half of the signs beside the other half: a thousand sums each instead of a million.
    first, second = (_signed_sums(half) for half in np.array_split(rises, 2))
    enough = second.size - np.searchsorted(np.sort(second), least - first)
    return float(np.mean(enough) / second.size)


def _signed_sums(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """(2ⁿ,) sums of n values with all choices of signs."""
    sums = np.zeros(1)
    for value in values:
        sums = np.concatenate([sums + value, sums - value])
    return sums

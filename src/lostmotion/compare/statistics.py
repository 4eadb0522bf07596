"""Medians over seeds, wins and losses against the reference row, with bootstrap intervals."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % bootstrap interval over seeds."""

    value: float
    low: float
    high: float


#: Resamples of the bootstrap, and its seed (option).
RESAMPLES, SEED = 2000, 0
#: Fewest seeds for a verdict: by chance alone five lie on one side in 6 % of all cases (option).
FEWEST_SEEDS = 5


def _indices(n: int) -> NDArray[np.int64]:
    return np.random.default_rng(SEED).integers(0, n, (RESAMPLES, n))


def median(values: Sequence[float]) -> Estimate:
    """Median over seeds; the interval by resampling the seeds (Efron 1979, percentiles)."""
    return _resampled(values, np.median)


def share(values: Sequence[float]) -> Estimate:
    """Share of seeds with a one, out of zeros and ones; the interval likewise."""
    return _resampled(values, np.mean)


def _resampled(values: Sequence[float], statistic: Callable[..., Any]) -> Estimate:
    array = np.asarray(values, dtype=float)
    low, high = np.percentile(statistic(array[_indices(array.size)], axis=1), [2.5, 97.5])
    return Estimate(float(statistic(array)), float(low), float(high))


def log_ratio(own: float, reference: float) -> float:
    """Logarithm of the ratio of two errors."""
    return math.log(max(own, 1e-12) / max(reference, 1e-12))


def ratio(own: Mapping[int, float], reference: Mapping[int, float]) -> Estimate | None:
    """Median over the common seeds of own error / reference error; None without a common seed."""
    seeds = sorted(set(own) & set(reference))
    logs = [log_ratio(own[s], reference[s]) for s in seeds]
    if not logs:
        return None
    found = median(logs)
    return Estimate(*(float(np.exp(v)) for v in (found.value, found.low, found.high)))


def overall(table: Mapping[str, Mapping[str, Mapping[int, float]]]) -> Estimate | None:
    """Geometric mean of the ratio to the reference over the cases of each group, then over groups, per seed.

    ``table``: group → case → seed → log of the ratio. Only seeds that every case has are used; they are
    resampled as a whole.
    """
    rows = [row for cases in table.values() for row in cases.values()]
    seeds = sorted(set.intersection(*map(set, rows))) if rows else []
    if not seeds:
        return None
    groups = [[[row[s] for s in seeds] for row in cases.values()] for cases in table.values() if cases]
    logs = np.mean([np.mean(cases, axis=0) for cases in groups], axis=0)
    low, high = np.percentile(logs[_indices(logs.size)].mean(axis=1), [2.5, 97.5])
    return Estimate(*(float(np.exp(v)) for v in (logs.mean(), low, high)))


def verdict(found: Estimate | None, seeds: int) -> str:
    """Win, loss or tie of one case: a win has its whole interval below 1; with few seeds none."""
    if found is None or seeds < FEWEST_SEEDS:
        return "–"
    if found.high < 1.0:
        return "win"
    return "loss" if found.low > 1.0 else "tie"

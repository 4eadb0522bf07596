"""The likelihood of innovations where the sensor's noise is the rounding of an encoder: uniform within a count.

Where the speed changes by less than a count from row to row, rounding has a pattern. Wrong parameters can follow it and
leave less of it than the true ones: as Gaussian noise that is likelier. But rounding has edges. A true model stays
within them, one that follows the pattern goes beyond.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Errors of a prediction over the rounding's standard deviation at least, and the share of the rows that the model
#: places wrong (numerics: impacts are placed to a fraction of a sample, and linearised).
LEAST, OUTLIERS = 0.05, 0.01
#: Errors of a prediction over the rounding's standard deviation from which on it is as Gaussian noise, and points of
#: the table up to there; points of a density, and how far it reaches in standard deviations (numerics).
LARGEST, POINTS, FINE, REACH = 30.0, 200, 4001, 8.0


def unlikelihood(innovations: Array, variances: Array) -> Array:
    """(n,) minus the logarithms of the likelihoods of innovations (n,), over the rounding's standard deviation, that
    the filter takes for as large as ``variances`` (n,), over its square; 0 where nothing but rounding is left."""
    from .....kernels.numerics.uniform_noise import fill_unlikelihood

    rows = np.empty(innovations.size)
    fill_unlikelihood(innovations, variances, LEAST, OUTLIERS, rows)
    return rows


def cost_as_gaussian(mean: float) -> float:
    """Cost of Gaussian noise that exceeds its size as much as these innovations exceed rounding, by their mean
    unlikelihood: 0 where nothing but rounding is left, 0.1 where errors make them 10 % larger."""
    means, costs = _as_gaussian()
    if mean >= means[-1]:
        return float(costs[-1] + mean - means[-1])
    return float(np.interp(mean, means, costs))


@cache
def _as_gaussian() -> tuple[Array, Array]:
    """Mean unlikelihoods of rounding and ever larger Gaussian errors of the prediction, and the costs of innovations
    that are as large and Gaussian; both from zero on."""
    from .....kernels.numerics.uniform_noise import HALF

    errors, means = np.geomspace(LEAST, LARGEST, POINTS), [0.0]
    for error in errors:
        at, step = np.linspace(-HALF - REACH * error, HALF + REACH * error, FINE, retstep=True)
        rows = unlikelihood(at, np.full(FINE, 1.0 + error**2))
        # The density that it stands for, but for the share of what is placed wrong.
        means.append(step * np.exp(-rows) @ rows / (step * np.sum(np.exp(-rows))))
    return np.array(means), np.append(0.0, 0.5 * np.log1p(errors**2))

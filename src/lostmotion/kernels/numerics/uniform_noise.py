"""How unlikely innovations are whose noise is the rounding of an encoder: uniform within a count."""

from __future__ import annotations

import math

import numpy as np

from ..jit import njit

#: Half of a count over the standard deviation of its rounding (physics: uniform within it).
HALF = math.sqrt(3.0)
#: An edge further away than so many standard deviations is not seen (numerics: a chance of 1e-9).
FAR = 6.0


@njit
def fill_unlikelihood(
    innovations: np.ndarray, variances: np.ndarray, least: float, outliers: float, result: np.ndarray
) -> None:
    """Minus the logarithm of the density of innovations (n,) times a count; 0 where nothing but rounding is left.

    Both in standard deviations of the rounding, or its variance, which the ``variances`` (n,) of the innovations
    contain. Their other part is Gaussian, of ``least`` at least: its sum with the rounding has soft edges. A share
    ``outliers`` is Gaussian altogether: what the model places wrong has no edges.
    """
    for i in range(innovations.size):
        size, error = abs(innovations[i]), math.sqrt(max(variances[i] - 1.0, least * least))
        variance = 1.0 + error * error
        near, opposite = (HALF - size) / error, (HALF + size) / error
        within = 1.0
        if near < FAR:
            within -= 0.5 * math.erfc(near / math.sqrt(2.0))
        if opposite < FAR:
            within -= 0.5 * math.erfc(opposite / math.sqrt(2.0))
        gaussian = 2.0 * HALF * math.exp(-0.5 * size * size / variance) / math.sqrt(2.0 * math.pi * variance)
        density = (1.0 - outliers) * max(within, 0.0) + outliers * gaussian
        result[i] = -math.log(density) if density > 0.0 else math.inf

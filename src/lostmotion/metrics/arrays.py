"""What the metrics take: arrays of finite numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InvalidInput

Array = NDArray[np.float64]


def finite(where: str, values: ArrayLike) -> Array:
    """The values as an array (n,); raises ``InvalidInput``, naming ``where``, unless all n > 0 are finite."""
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or array.size == 0 or not np.all(np.isfinite(array)):
        raise InvalidInput(
            f"metrics: {where}",
            f"shape {array.shape}, {np.count_nonzero(~np.isfinite(array))} values not finite",
            "a one-dimensional array of finite numbers",
            "Drop or replace NaN and infinity first.",
        )
    return array


def pair(a: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    """Both as ``finite`` arrays (n,); raises ``InvalidInput`` where one is not, or their lengths differ."""
    first, second = finite("first array", a), finite("second array", b)
    if first.shape != second.shape:
        raise InvalidInput(
            "metrics",
            f"{first.size} and {second.size} values",
            "two equally long arrays",
            "Bring both to one time axis.",
        )
    return first, second

"""Linear least squares with intervals for a residual of any colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .block_covariance import BLOCKS, student_factor

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LinearFit:
    """y ≈ Σ values[i]·columns[i].

    Attributes
    ----------
    values, margins : (p,) arrays
        Least-squares values and the half widths of their 95 % intervals.
    fitted, residual : (n,) arrays
    """

    values: Floats
    margins: Floats
    fitted: Floats
    residual: Floats


def linear_fit(columns: Floats, y: Floats) -> LinearFit:
    """Least squares of y (n,) on columns (p, n), the columns brought to one size first.

    Intervals: jackknife over 20 blocks of consecutive rows, Student's t. Where a few blocks determine a parameter, as
    the instants of a torque step the inertia, the sandwich form is too narrow: the fit bends towards them.
    """
    size = np.maximum(np.sqrt((columns**2).mean(axis=1)), np.finfo(float).tiny)
    scaled = columns / size[:, None]
    values = np.linalg.lstsq(scaled.T, y, rcond=None)[0]
    fitted = values @ scaled
    block = np.arange(y.size) * BLOCKS // y.size
    square, right = scaled @ scaled.T, scaled @ y
    without = []
    for number in range(BLOCKS):
        part = scaled[:, block == number]
        # A parameter that only this block determines keeps its value in the direction that is lost: least norm of the
        # step.
        left = right - part @ y[block == number] - (square - part @ part.T) @ values
        without.append(np.linalg.lstsq(square - part @ part.T, left, rcond=1e-10)[0])
    spread = np.array(without) - np.mean(without, axis=0)
    variance = (BLOCKS - 1) / BLOCKS * (spread**2).sum(axis=0)
    margins = student_factor(len(values)) * np.sqrt(variance)
    return LinearFit(values / size, margins / size, fitted, y - fitted)

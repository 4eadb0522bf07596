"""Linear least squares with intervals that hold for a residual of any colour."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .uncertainty import sandwich, student_factor

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LinearFit:
    """y ≈ Σ values[i]·columns[i].

    Attributes
    ----------
    values, margins : (p,) arrays
        Least-squares values and the half widths of their 95 % intervals.
    covariance : (p, p) array
        Sandwich over blocks, see ``uncertainty.sandwich``.
    fitted, residual : (n,) arrays
    """

    values: Floats
    margins: Floats
    covariance: Floats
    fitted: Floats
    residual: Floats

    @property
    def relative_error(self) -> float:
        """‖residual‖ / ‖y‖."""
        return float(np.linalg.norm(self.residual) / np.linalg.norm(self.residual + self.fitted))


def linear_fit(columns: Floats, y: Floats) -> LinearFit:
    """Least squares of y (n,) on columns (p, n), the columns brought to one size first."""
    size = np.maximum(np.sqrt((columns**2).mean(axis=1)), np.finfo(float).tiny)
    scaled = columns / size[:, None]
    values = np.linalg.lstsq(scaled.T, y, rcond=None)[0]
    fitted = values @ scaled
    residual = y - fitted
    covariance = sandwich(scaled, residual) / np.outer(size, size)
    margins = student_factor(len(values)) * np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return LinearFit(values / size, margins, covariance, fitted, residual)

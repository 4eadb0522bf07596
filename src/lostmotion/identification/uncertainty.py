"""How well the parameters are known: statistics of the fit, and an allowance for what the model leaves out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Blocks of the recording whose scores count as independent (chosen: 0.2 s each in 10 s, several times the
#: slowest time constant of the observer).
BLOCKS = 50

#: A spectral peak counts as an unmodelled mode if it stands this far above the median of its band (chosen; blue
#: quantisation noise alone reaches 2).
PEAK_RATIO = 10.0

#: Relative allowance for the damping if there is an unmodelled mode (chosen: on finer plants the fitted damping
#: was 20 to 50 % above that of the shaft, because the impacts feed energy into the mode).
DAMPING_ALLOWANCE = 0.5


def sandwich(jacobian: Array, residual: Array) -> Array:
    """Covariance H⁻¹ S H⁻¹ of the parameters; valid for a residual of any colour.

    H = J Jᵀ, and S sums the outer products of the scores of ``BLOCKS`` blocks (White 1980, with blocks for the
    autocorrelation). A direction without information gets a huge variance instead of an error.

    Parameters
    ----------
    jacobian : (p, n) array
    residual : (n,) array
    """
    p, n = jacobian.shape
    length = n // BLOCKS
    scores = (jacobian * residual)[:, : length * BLOCKS].reshape(p, BLOCKS, length).sum(axis=2)
    scale = np.sqrt(np.maximum(np.einsum("ij,ij->i", jacobian, jacobian), 1e-300))
    hessian = (jacobian @ jacobian.T) / np.outer(scale, scale)
    inverse = np.linalg.inv(hessian + 1e-12 * np.eye(p)) / np.outer(scale, scale)
    spread = scores @ scores.T * BLOCKS / (BLOCKS - p)
    return np.asarray(inverse @ spread @ inverse)


def student_factor(p: int) -> float:
    """Half width of a 95 % interval in standard deviations, with p parameters estimated from the blocks."""
    from scipy.stats import t

    return float(t.ppf(0.975, BLOCKS - p))


def gauss_newton_shift(jacobian: Array, residual: Array) -> Array:
    """(p,) step that these innovations ask for: how far another weighting would move the estimate."""
    return np.asarray(np.linalg.lstsq(jacobian.T, -residual, rcond=1e-10)[0])


def unmodelled_mode(residual: Array, dt: float, pole_frequency: float) -> float | None:
    """Frequency (Hz) of the highest peak of the residual's spectrum above twice the torsional mode, if any."""
    from scipy.signal import welch

    frequency, power = welch(residual, fs=1.0 / dt, nperseg=min(4096, residual.size))
    band = (frequency > 2.0 * pole_frequency) & (frequency < 0.4 / dt)
    if np.count_nonzero(band) < 20:
        return None
    peak = int(np.argmax(np.where(band, power, 0.0)))
    return float(frequency[peak]) if power[peak] > PEAK_RATIO * np.median(power[band]) else None


def model_allowance(names: tuple[str, ...], inertia_ratio: float, pole: float, mode: float | None) -> Array:
    """Half widths (relative) for a mode that a two-mass model does not have.

    Below its frequency such a mode changes the inertia and the stiffness seen at the torsional mode by the
    relative amount (pole / mode)², to first order; twice that is allowed (chosen, for 95 %) for motor inertia,
    stiffness and backlash. The total inertia is not touched, so the load inertia has the motor's allowance in
    kg m².

    Parameters
    ----------
    names : tuple of str
    inertia_ratio : float
        inertia_motor / inertia_load.
    pole, mode : float, Hz
    """
    if mode is None:
        return np.zeros(len(names))
    base = 2.0 * (pole / mode) ** 2
    allowances = {
        "inertia_motor": base,
        "stiffness": base,
        "backlash": base,
        "inertia_load": base * inertia_ratio,
        "damping": DAMPING_ALLOWANCE,
    }
    return np.array([allowances.get(name, 0.0) for name in names])

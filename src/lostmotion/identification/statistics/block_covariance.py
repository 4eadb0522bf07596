"""Covariances for noise of any colour: from blocks of a recording that are treated as independent."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Blocks of the recording whose scores are treated as independent (numerics: 0.5 s each in 10 s, several times the
#: slowest time constant of the observer, and about as long as a speed level lasts).
BLOCKS = 20

#: Lower bound on 1 − leverage of a block (numerics: influences grow fivefold at most).
LEAST_REST = 0.2


def normal_equations(jacobian: Array, residual: Array) -> tuple[Array, Array]:
    """J Jᵀ (p, p) and J r (p,) for J (p, n), without BLAS."""
    return np.einsum("ik,jk->ij", jacobian, jacobian), np.einsum("ik,k->i", jacobian, residual)


@dataclass(frozen=True, eq=False)
class Blocks:
    """Normal equations of a fit, block by block of the recording.

    Parameters
    ----------
    hessians : (BLOCKS, p, p) array
    gradients : (p, BLOCKS) array
    """

    hessians: Array
    gradients: Array

    @classmethod
    def of(cls, jacobian: Array, residual: Array) -> Blocks:
        """From a Jacobian (p, n) and a residual (n,); a remainder of rows goes to the last blocks."""
        ends = np.linspace(0, residual.size, BLOCKS + 1).astype(int)
        parts = [normal_equations(jacobian[:, i:j], residual[i:j]) for i, j in pairwise(ends)]
        return cls(np.array([h for h, _ in parts]), np.array([g for _, g in parts]).T)

    @cached_property
    def step(self) -> Array:
        """(p,) Gauss–Newton step; zero for a parameter without information."""
        hessian, scale = self._scaled(self.hessians.sum(axis=0))
        step = np.linalg.lstsq(hessian, -self.gradients.sum(axis=1) / scale, rcond=1e-10)[0]
        return np.asarray(step / scale)

    @cached_property
    def influences(self) -> Array:
        """(p, BLOCKS): influence of each block on the estimate.

        A block of high leverage bends the fit towards itself; as in a jackknife its influence is divided by
        1 − leverage (Bell & McCaffrey 2002, "CR3").
        """
        hessian, scale = self._scaled(self.hessians.sum(axis=0))
        # A direction without information gets a huge variance instead of an error.
        root = np.linalg.cholesky(hessian + 1e-12 * np.eye(scale.size))
        inverse = np.linalg.inv(root)
        pulls = np.empty(self.gradients.shape)
        for block, own in enumerate(self.hessians):
            share, axes = np.linalg.eigh(inverse @ (own / np.outer(scale, scale)) @ inverse.T)
            weight = 1.0 / np.maximum(1.0 - share, LEAST_REST)
            score = axes.T @ (inverse @ (self.gradients[:, block] / scale))
            pulls[:, block] = -inverse.T @ (axes @ (weight * score)) / scale
        return pulls

    @staticmethod
    def _scaled(hessian: Array) -> tuple[Array, Array]:
        scale = np.sqrt(np.maximum(np.diag(hessian), 1e-300))
        return hessian / np.outer(scale, scale), scale


def covariance(influences: Array) -> Array:
    """(p, p) covariance of an estimate from the influences of its blocks, (p, BLOCKS), for a residual of any colour."""
    centred = influences - influences.mean(axis=1, keepdims=True)
    return np.asarray(centred @ centred.T * BLOCKS / (BLOCKS - 1))


def sandwich(jacobian: Array, residual: Array) -> Array:
    """Covariance H⁻¹ S H⁻¹ of the parameters; valid for a residual of any colour.

    H = J Jᵀ, and S sums the outer products of the scores of ``BLOCKS`` blocks (White 1980, with blocks for
    the autocorrelation), each enlarged as ``Blocks.influences`` says.

    Parameters
    ----------
    jacobian : (p, n) array
    residual : (n,) array
    """
    return covariance(Blocks.of(jacobian, residual).influences)


def excess(value: Array, spread: Array, factor: float) -> Array:
    """Part of (p,) shifts that exceeds their noise level: √(value² − (factor · standard deviation)²), or zero.

    Parameters
    ----------
    value : (p,) array
    spread : (p, BLOCKS) array
        Contribution of each block of the recording.
    factor : float
        Half width of an interval in standard deviations.
    """
    chance = factor**2 * np.diag(covariance(spread))
    return np.asarray(np.sqrt(np.maximum(value**2 - chance, 0.0)))


def student_factor(p: int) -> float:
    """Half width of a 95 % interval in standard deviations, with p parameters estimated from the blocks."""
    from scipy.stats import t

    return float(t.ppf(0.975, BLOCKS - p))


def block_squares(residual: Array) -> Array:
    """(BLOCKS,) sums of squares of a residual's (n,) blocks."""
    length = residual.size // BLOCKS
    return np.asarray(np.square(residual[: length * BLOCKS]).reshape(BLOCKS, length).sum(axis=1))


def growth(residual: Array, reference: Array) -> tuple[float, float]:
    """How much larger the sum of squares of a residual is than that of a reference, both (n,).

    Returns
    -------
    (float, float)
        In multiples of the reference's mean sum over one of ``BLOCKS`` blocks; and the t statistic of the mean of the
        blocks' differences, which is small where a single block makes all of it.
    """
    difference = block_squares(residual) - block_squares(reference)
    deviation = float(np.std(difference, ddof=1)) / np.sqrt(BLOCKS)
    typical = float(np.mean(block_squares(reference)))
    mean = float(np.mean(difference))
    return BLOCKS * mean / max(typical, 1e-300), mean / max(deviation, 1e-300)


def shift(jacobian: Array, residual: Array) -> Array:
    """(p,) Gauss–Newton step that these innovations ask for.

    Zero for a parameter without information.
    """
    return Blocks.of(jacobian, residual).step

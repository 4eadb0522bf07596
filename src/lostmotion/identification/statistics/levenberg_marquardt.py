"""Levenberg–Marquardt with bounds on the step and on the number of iterations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .block_covariance import normal_equations

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fit:
    """Minimum found: parameters, residual (n,), its sum of squares, iterations, and whether it converged."""

    theta: Array
    residual: Array
    cost: float
    iterations: int
    converged: bool


#: Largest step in a logarithm: a factor of two (numerics; larger ones jump over valleys of a cost with a gap).
LARGEST_STEP = 0.7

#: A step is the last one when all its logarithms move by less than this (numerics: a fiftieth of an interval).
SMALLEST_STEP = 2e-4

#: Or when it lowers the cost by less than this fraction (numerics).
SMALLEST_GAIN = 1e-7


def minimise(
    residual: Callable[[Array], Array],
    jacobian: Callable[[Array, Array], Array],
    theta: Array,
    free: list[int],
    lower: Array,
    upper: Array,
    iterations: int,
    smallest_gain: float = SMALLEST_GAIN,
) -> Fit:
    """Lower the sum of squares of ``residual(theta)`` over the ``free`` entries of theta.

    Parameters
    ----------
    residual : theta → (n,)
    jacobian : theta, residual → (len(free), n)
    lower, upper : arrays like theta
        Steps are cut at these bounds.
    iterations : int
        At most so many steps.
    smallest_gain : float
        A step that lowers the cost by less than this fraction is the last one.
    """
    fit = Fit(theta.copy(), *_evaluate(residual, theta), 0, not free)
    iterations = iterations if free else 0
    damping = 1e-3
    for count in range(1, iterations + 1):
        j = jacobian(fit.theta, fit.residual)
        hessian, gradient = normal_equations(j, fit.residual)
        for _ in range(6):
            trial = fit.theta.copy()
            trial[free] += _step(hessian, gradient, damping)
            trial[free] = np.clip(trial[free], lower[free], upper[free])
            r, cost = _evaluate(residual, trial)
            if cost < fit.cost:
                break
            damping = max(8.0 * damping, 1e-4)
        else:
            # No lower cost in any direction between Gauss–Newton and steepest descent: the bottom.
            return Fit(fit.theta, fit.residual, fit.cost, count, True)
        moved = np.max(np.abs(trial[free] - fit.theta[free]))
        small = moved < SMALLEST_STEP or fit.cost - cost < smallest_gain * fit.cost
        damping = max(damping / 8.0, 1e-8)
        fit = Fit(trial, r, cost, count, bool(small))
        if small:
            break
    return fit


def sum_of_squares(residual: Array) -> float:
    """Infinite for a residual that is not finite. Without BLAS, whose threads stall on a busy machine."""
    cost = float(np.einsum("i,i->", residual, residual))
    return cost if np.isfinite(cost) else np.inf


def _evaluate(residual: Callable[[Array], Array], theta: Array) -> tuple[Array, float]:
    r = residual(theta)
    cost = sum_of_squares(r)
    return r, cost


def _step(hessian: Array, gradient: Array, damping: float) -> Array:
    diagonal = np.diag(hessian)
    weight = np.diag(damping * diagonal + 1e-12 * np.max(diagonal) + 1e-300)
    return np.asarray(np.clip(-np.linalg.solve(hessian + weight, gradient), -LARGEST_STEP, LARGEST_STEP))

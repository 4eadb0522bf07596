"""Gauss–Newton steps in a trust region: how the contact-switching filter descends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...statistics.block_covariance import normal_equations
from .filter import ContactFilter

Array = NDArray[np.float64]

#: Radius of the trust region in θ: first, largest and smallest, and by how much it shrinks after a failure (numerics).
RADIUS, LARGEST, SMALLEST, SHRINK = 0.5, 1.0, 1e-4, 0.2
#: Radii that are tried in a step (numerics: narrow valleys need a hundredth of a step across them).
TRIES = 5
#: Dampings side by side, from the least to the largest, and rounds of finer ones between two (numerics: the radius to
#: 0.1 %; one after the other they take six times as long).
BETWEEN, ROUNDS = np.linspace(0.0, 1.0, 64), 3
#: A step that lowers the cost by less is the last one (numerics).
GAIN = 1e-4


def minimise_within(
    flt: ContactFilter, theta: Array, free: list[int], bounds: tuple[Array, Array], iterations: int
) -> tuple[Array, float]:
    """θ and cost after Gauss–Newton steps over the free entries of θ in a trust region, one at least.

    What would go beyond a bound stops there, and the others' steps are those beside it. A step lowers the cost of
    Gaussian noise, whose slopes it has; of all that are passed, those of the lowest cost are taken.
    """
    best, radius, (lower, upper) = (theta, np.inf), RADIUS, bounds
    for _ in range(iterations):
        run = flt.run(theta, free)
        best = min(best, (theta, run.cost), key=lambda one: one[1])
        if not np.all(np.isfinite(run.jacobian)):
            break
        hessian, gradient = normal_equations(run.jacobian, run.weighted)
        moves = np.where(gradient > 0.0, theta[free] > lower, theta[free] < upper)
        if not np.any(moves):
            break
        room = (lower - theta[free], upper - theta[free])
        for attempt in range(TRIES):
            trial = theta.copy()
            step = step_within(hessian, gradient, moves, room, radius)
            trial[free] = np.clip(theta[free] + step, lower, upper)
            reached = flt.run(trial)
            if reached.gaussian < run.gaussian:
                radius = min(radius * (1.0 if attempt else 2.0), LARGEST)
                break
            radius = max(radius * SHRINK, SMALLEST)
        else:
            break
        theta = trial
        best = min(best, (theta, reached.cost), key=lambda one: one[1])
        if run.gaussian - reached.gaussian < GAIN:
            break
    return best


def step_within(
    hessian: Array, gradient: Array, moves: NDArray[np.bool_], room: tuple[Array, Array], radius: float
) -> Array:
    """Step that stays in the room (least, most). What does not move or stops at a bound is known to the others' steps:
    cut off afterwards, it left them with a change of its own that nothing made up for."""
    step, moves, (least, most) = np.zeros(gradient.size), moves.copy(), room
    while np.any(moves):
        known = hessian[np.ix_(moves, ~moves)] @ step[~moves]
        step[moves] = _step(hessian[np.ix_(moves, moves)], gradient[moves] + known, radius)
        beyond = moves & ((step < least) | (step > most))
        if not np.any(beyond):
            break
        step[beyond] = np.clip(step, least, most)[beyond]
        moves &= ~beyond
    return step


def _step(hessian: Array, gradient: Array, radius: float) -> Array:
    """Gauss–Newton step whose largest entry is the radius at most, damped in the Hessian's own axes."""
    curvature, axes = np.linalg.eigh(np.where(np.isfinite(hessian), hessian, 0.0))
    curvature, slope = np.maximum(curvature, 0.0), axes.T @ gradient

    def step(damping: Array) -> Array:
        return np.asarray(-axes @ (slope[:, None] / (curvature[:, None] + damping)))

    low = 1e-12 * curvature[-1] + 1e-300
    first = step(np.array([low]))[:, 0]
    if np.max(np.abs(first)) <= radius:
        return first
    high = max(2.0 * np.max(np.abs(slope)) / radius * np.sqrt(slope.size), 10.0 * low)
    for _ in range(ROUNDS):
        dampings = low * (high / low) ** BETWEEN
        steps = step(dampings)
        fits = np.max(np.abs(steps), axis=0) <= radius
        fits[-1] = True  # but for rounding it does
        least = int(np.argmax(fits))
        low, high = dampings[max(least - 1, 0)], dampings[least]
    return np.asarray(steps[:, least])

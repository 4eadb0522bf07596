"""Gauss–Newton steps in a trust region, with secant steps between them: how the contact-switching filter descends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...statistics.block_covariance import normal_equations
from .filter import ContactFilter, Run

Array = NDArray[np.float64]

#: Radius of the trust region in θ: first, largest and smallest, and by how much it shrinks after a failure (numerics).
RADIUS, LARGEST, SMALLEST, SHRINK = 0.5, 1.0, 1e-4, 0.2
#: Radii that are tried in a step (numerics: narrow valleys need a hundredth of a step across them).
TRIES = 5
#: A step that lowers the cost by less is the last one (numerics).
GAIN = 1e-4
#: Secant steps after a Gauss–Newton step at most, and the part of what that gained below which they end (numerics).
SECANTS, SECANT_GAIN = 3, 0.02


@dataclass(frozen=True, eq=False)
class Bounds:
    """Bounds (m,) of the free entries of θ."""

    free: list[int]
    lower: Array
    upper: Array


@dataclass(frozen=True, eq=False)
class Linear:
    """Weighted innovations (n,) near a θ: how they are there, and their change with the free entries (m, n)."""

    theta: Array
    weighted: Array
    jacobian: Array

    @cached_property
    def _normal(self) -> tuple[Array, Array]:
        return normal_equations(self.jacobian, self.weighted)

    def step(self, bounds: Bounds, radius: float) -> Array | None:
        """θ after a step; None where all that would move is at its bound."""
        (hessian, gradient), own = self._normal, self.theta[bounds.free]
        moves = np.where(gradient > 0.0, own > bounds.lower, own < bounds.upper)
        if not np.any(moves):
            return None
        room, theta = (bounds.lower - own, bounds.upper - own), self.theta.copy()
        own = own + step_within(hessian, gradient, moves, room, radius)
        theta[bounds.free] = np.clip(own, bounds.lower, bounds.upper)
        return theta

    def corrected(self, bounds: Bounds, theta: Array, weighted: Array) -> Linear:
        """The same at another θ, where the innovations are known: the sensitivities are those that explain the step.

        Source: Broyden (1965), A class of methods for solving nonlinear simultaneous equations, Mathematics of
        Computation 19, section 4.
        """
        step = theta[bounds.free] - self.theta[bounds.free]
        missed = weighted - self.weighted - step @ self.jacobian
        return Linear(theta, weighted, self.jacobian + np.outer(step / (step @ step), missed))


def minimise_within(flt: ContactFilter, theta: Array, bounds: Bounds, iterations: int) -> tuple[Array, float]:
    """θ and cost after Gauss–Newton steps over the free entries of θ in a trust region, one at least.

    What would go beyond a bound stops there, and the others' steps are those beside it. Secant steps follow each: a
    pass with sensitivities takes as long as five without.
    """
    cost, radius = np.inf, RADIUS
    for _ in range(iterations):
        run = flt.run(theta, bounds.free)
        cost = run.cost
        if not np.all(np.isfinite(run.jacobian)):
            break
        here = Linear(theta, run.weighted, run.jacobian)
        for attempt in range(TRIES):
            trial = here.step(bounds, radius)
            if trial is None:
                return theta, cost
            reached = flt.run(trial)
            if reached.cost < cost:
                radius = min(radius * (1.0 if attempt else 2.0), LARGEST)
                break
            radius = max(radius * SHRINK, SMALLEST)
        else:
            break
        theta, cost = _after_secants(flt, here, run, trial, reached, bounds, radius)
        if run.cost - cost < GAIN:
            break
    return theta, cost


def _after_secants(
    flt: ContactFilter, here: Linear, run: Run, theta: Array, reached: Run, bounds: Bounds, radius: float
) -> tuple[Array, float]:
    """θ and cost after secant steps from θ, which a step from ``here`` has reached."""
    gain = run.cost - reached.cost
    least = max(GAIN, SECANT_GAIN * gain)
    for _ in range(SECANTS):
        weighted = _weighted_alike(reached, run)
        if gain < least or weighted is None:
            break
        here = here.corrected(bounds, theta, weighted)
        trial = here.step(bounds, radius)
        if trial is None:
            break
        after = flt.run(trial)
        if not after.cost < reached.cost:
            break
        gain = reached.cost - after.cost
        theta, reached = trial, after
    return theta, reached.cost


def _weighted_alike(run: Run, like: Run) -> Array | None:
    """Innovations over the deviations of another pass: these are taken as they are, as sensitivities take them."""
    if run.weighted.size != like.weighted.size or not np.all(np.isfinite(run.weighted)):
        return None
    weighted, rows = run.weighted.copy(), run.deviations.size
    weighted[:rows] *= run.deviations / like.deviations
    return weighted


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

    def step(damping: float) -> Array:
        return np.asarray(-axes @ (slope / (curvature + damping)))

    low = 1e-12 * curvature[-1] + 1e-300
    first = step(low)
    if np.max(np.abs(first)) <= radius:
        return first
    high = max(2.0 * np.max(np.abs(slope)) / radius * np.sqrt(slope.size), 10.0 * low)
    bounds = [np.log(low), np.log(high)]
    for _ in range(40):
        middle = 0.5 * sum(bounds)
        bounds[int(np.max(np.abs(step(np.exp(middle)))) <= radius)] = middle
    return step(np.exp(bounds[1]))

"""Maximum likelihood with the contact-switching filter: descents that impacts do not stop, and its noise."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..innovations import THREADS
from .filter import ContactFilter, Run
from .gauss_newton import minimise_within
from .parameter_vector import FRICTIONS, INDEX, NAMES, PARAMETERS, pole_of
from .sensor.counting_rows import MOVED

Array = NDArray[np.float64]
Item = TypeVar("Item")
Result = TypeVar("Result")

#: First noise level of a descent over the motion's own, that from values that were fitted already, and the factor from
#: level to level (numerics).
FIRST_LEVEL, FITTED_LEVEL, LEVEL_FACTOR = 0.03, 0.003, 5.0
#: Gauss–Newton steps of a descent at one noise level (numerics).
STEPS = 8
#: What the filter does not know: rates of unknown torques, and the share by which an impact may be off; and the factor
#: by which they are searched (numerics).
RATES, RATE_FACTOR = ("motor_rate", "load_rate", "torque_rate", "impact"), 3.0
#: Rounds of fitting the parameters and the rates in turn at most; a round that lowers the cost by less is the last one.
#: (Numerics: what the filter follows with an unknown torque it does not follow with its parameters, so that both
#: change together, and slowly.)
ROUNDS, ROUND_GAIN = 3, 1e-3
#: What has bounds of its own, wherever a descent starts.
BOUNDED = (
    *FRICTIONS, "lag", "delay", "torque_offset", "share", "compliance", "loss",
    "rise", "fade", "rise_motor", "fade_motor", "share_fourth", "compliance_fourth", "loss_fourth",
)  # fmt: skip
#: Constant torque on the motor at most, over the torque's standard deviation; loss factor of the shaft beyond a third
#: inertia over that at the gap, either way (numerics: hardly damped steel beside rubber).
MOST_OFFSET, MOST_LOSS = 5.0, 1e4
#: Friction at least, in its unit, and at most, over the torque's deviation (numerics: the smallest is none, the largest
#: holds the drive; a ten thousandth still shows in 18 bit).
LEAST_FRICTION, MOST_FRICTION = 1e-8, 100.0
#: Rise of a friction towards rest at most, and the speeds over which it fades, over the speed's standard deviation
#: (numerics: a slower one is not seen, a faster one is viscous).
MOST_RISE, FADE_BOUNDS = 3.0, (3e-3, 1.0)
#: Speed over its standard deviation from which on an end moves (calibrated on 18 development drives of 3460 to 3820,
#: 2026-11-27: of 1e-6 to 1e-2 that whose speeds give the true curve the true line); rows that stand for all (numerics).
MOVES, SOME = 1e-3, 2000


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds of θ, one for each of ``PARAMETERS``."""

    lower: Array
    upper: Array

    @classmethod
    def around(cls, flt: ContactFilter, theta: Array, far: float) -> Box:
        """Within a factor ``far``, its square for a backlash, which a nameplate may lack; lag and delay within 20 ms,
        parts below one, friction anything from none on.

        A measured torque is ahead of that which acts by a sample at most: it is what acted at the row.
        """
        lower, upper = theta - np.log(far), theta + np.log(far)
        lower[INDEX["backlash"]] -= np.log(far)
        upper[INDEX["backlash"]] += np.log(far)
        lower[INDEX["lag"]], upper[INDEX["lag"]] = np.log(1.02 * flt.dt), np.log(flt.dt + 0.02)
        lower[INDEX["delay"]], upper[INDEX["delay"]] = -1.0, 0.02 / flt.dt
        largest = {"friction": flt.torque_size / flt.units[1], "damper": flt.damper_size / flt.units[2]}
        for name in FRICTIONS:
            lower[INDEX[name]], upper[INDEX[name]] = LEAST_FRICTION, MOST_FRICTION * largest[PARAMETERS[name]]
        lower[INDEX["torque_offset"]], upper[INDEX["torque_offset"]] = -MOST_OFFSET, MOST_OFFSET
        for name, least, most in (
            ("share", 2e-3, 0.95),
            ("compliance", 0.01, 0.99),
            ("loss", 1.0 / MOST_LOSS, MOST_LOSS),
        ):
            for place in (INDEX[name], INDEX[f"{name}_fourth"]):
                lower[place], upper[place] = np.log(least), np.log(most)
        for end in ("", "_motor"):
            lower[INDEX[f"rise{end}"]], upper[INDEX[f"rise{end}"]] = 0.0, MOST_RISE
            fade = INDEX[f"fade{end}"]
            lower[fade], upper[fade] = np.log(np.array(FADE_BOUNDS) * flt.speed_deviation)
        return cls(lower, upper)

    def including(self, theta: Array, far: float) -> Box:
        """Wide enough for a factor ``far`` around another θ, too; what has bounds of its own keeps them."""
        lower, upper = (
            np.minimum(self.lower, theta - np.log(far)),
            np.maximum(self.upper, theta + np.log(far)),
        )
        own = [INDEX[name] for name in BOUNDED]
        lower[own], upper[own] = self.lower[own], self.upper[own]
        return Box(lower, upper)


def side_by_side(function: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """The function of each, on two threads: the passes of the filter leave the interpreter free."""
    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(function, items))


def minimise(
    flt: ContactFilter, theta: Array, free: list[int], box: Box, iterations: int
) -> tuple[Array, float]:
    """θ and cost after Gauss–Newton steps over the free entries of θ within a box, one at least."""
    # What began outside of the box moves on from there.
    lower, upper = np.minimum(box.lower[free], theta[free]), np.maximum(box.upper[free], theta[free])
    return minimise_within(flt, theta, free, (lower, upper), iterations)


def inverse_hessian(jacobian: Array) -> Array:
    """(m, m) inverse of J·Jᵀ; a direction without information gets a huge, finite variance."""
    hessian = np.einsum("ik,jk->ij", jacobian, jacobian)
    # The variance must not overflow: one such direction would make all weights NaN.
    scale = np.sqrt(np.maximum(np.diag(hessian), 1e-24 * np.max(np.diag(hessian)) + 1e-200))
    scaled = hessian / np.outer(scale, scale) + 1e-10 * np.eye(scale.size)
    with np.errstate(over="ignore"):
        return np.asarray(np.linalg.inv(scaled) / np.outer(scale, scale))


@dataclass(frozen=True, eq=False)
class Candidate:
    """A minimum: where its descent started, θ, the cost, and the filter with level and law."""

    start: str
    theta: Array
    cost: float
    flt: ContactFilter
    free: list[int]

    @cached_property
    def run(self) -> Run:
        """The pass at θ, with its sensitivities to the free parameters."""
        return self.flt.run(self.theta, self.free)

    @cached_property
    def speeds(self) -> tuple[Array, Array]:
        """Sizes of the speeds, rad/s, at which load and motor move in the whole recording; of some thousand rows."""
        return self.speeds_above(MOVES)

    def speeds_above(self, least: float) -> tuple[Array, Array]:
        """The same above this part of the speed's standard deviation."""
        flt, load = self._over_the_whole
        least *= flt.speed_deviation
        return _some(load, least), _some(np.abs(flt.motor_speed), max(least, MOVED * flt.motor_speed_noise))

    @cached_property
    def _over_the_whole(self) -> tuple[ContactFilter, Array]:
        """The filter over the whole recording, and sizes of the load's speed (n,), rad/s, there; where it loses the
        motion, of those in its own rows, and where it does there as well, of the motor's."""
        flt = replace(self.over(self.flt.whole or self.flt), level=self.flt.level)
        for rows in (flt, self.flt):
            load = np.abs(rows.load_speed(self.theta))
            if np.all(np.isfinite(load)):
                return flt, load
        return flt, np.abs(flt.motor_speed)

    @property
    def values(self) -> dict[str, float]:
        """Values of the kernel's parameters by name, SI."""
        return dict(zip(NAMES, map(float, self.flt.values(self.theta)), strict=True))

    @property
    def structure(self) -> tuple[Hashable, ...]:
        """What the model consists of, but for the gap."""
        flt, third, fourth = self.flt, self._has("share"), self._has("share_fourth")
        sides = (third and flt.behind, fourth and flt.fourth_behind)
        return flt.law, flt.ramp, flt.drifts, third, fourth, *sides, self.rises

    def _has(self, name: str) -> bool:
        return bool(np.isfinite(self.theta[INDEX[name]]))

    def contains(self, other: Candidate) -> bool:
        """Whether it has all parts of the other, under the same laws."""
        mine, its = self.structure, other.structure
        # A fourth inertia is one beside a third on its side.
        third = not its[3] or (mine[3], mine[5]) == (its[3], its[5])
        fourth = not its[4] or (mine[4], mine[6]) == (its[4], its[6])
        return mine[:3] == its[:3] and third and fourth and (self.rises or not other.rises)

    @property
    def rises(self) -> bool:
        """Whether the rise of a friction towards rest is fitted."""
        return INDEX["rise"] in self.free or INDEX["rise_motor"] in self.free

    def over(self, rows: ContactFilter) -> ContactFilter:
        """The filter over other rows, with what this candidate takes for the torques and the contact."""
        flt = self.flt
        return replace(
            rows,
            ramp=flt.ramp,
            drifts=flt.drifts,
            law=flt.law,
            behind=flt.behind,
            fourth_behind=flt.fourth_behind,
        )


def _some(sizes: Array, least: float) -> Array:
    """Some thousand of the sizes above a least one; of all, where these tell no line."""
    above = sizes[sizes > least]
    found = above if above.size > SOME // 100 else sizes
    return found[:: max(1, found.size // SOME)]


def cost_of(one: Candidate) -> float:
    return one.cost


def first_level(flt: ContactFilter, theta: Array, first: float) -> float:
    """Noise level of ``first`` times the motion's own size, the sensor's at least."""
    own = flt.speed_deviation / (2.0 * np.pi * pole_of(theta) if flt.counted else 1.0)
    return max(first * own, flt.floor)


def descend(
    start: str,
    flt: ContactFilter,
    theta: Array,
    free: list[int],
    box: Box,
    first: float = FIRST_LEVEL,
    iterations: int = STEPS,
) -> Candidate:
    """The best of the fits with ever lower noise level; ``first`` is in multiples of the motion's own size."""
    level, best = first_level(flt, theta, first), None
    while True:
        at = replace(flt, level=level)
        theta, cost = minimise(at, theta, free, box, iterations)
        if best is None or cost < best.cost:
            best = Candidate(start, theta, cost, at, free)
        if level <= flt.floor:
            return best
        level = max(level / LEVEL_FACTOR, flt.floor)


def polish(candidate: Candidate, flt: ContactFilter, box: Box, iterations: int = STEPS) -> Candidate:
    """The candidate on other rows or under another law, with the rates of its unknown torques fitted as well."""
    at = replace(flt, level=candidate.flt.level)
    theta, cost = minimise(at, candidate.theta, candidate.free, box, iterations)
    found = replace(candidate, theta=theta, cost=cost, flt=at)
    for _ in range(ROUNDS):
        before = found.cost
        found = rates_first(found, box, iterations)
        if not before - found.cost > ROUND_GAIN:
            break
    return found


def rates_first(
    candidate: Candidate, box: Box, iterations: int, rows: ContactFilter | None = None
) -> Candidate:
    """The candidate after a few steps with rates at which its filter is not lost, there or over other rows: what it
    follows with an unknown torque at first, it follows with its parameters then."""
    flt, free = candidate.flt, candidate.free
    theta, cost = minimise(flt, fitted_rates(rows or flt, candidate.theta), free, box, iterations)
    return replace(candidate, theta=theta, cost=cost)


def fitted_rates(flt: ContactFilter, theta: Array, names: Sequence[str] = RATES) -> Array:
    """θ with the rates, factor by factor, where the cost is lowest; twice around."""
    cost, settled = flt.run(theta).cost, set[str]()
    for name in (*names, *names):
        if name in settled:  # no other has changed since
            continue
        start = cost
        for factor in (RATE_FACTOR, 1.0 / RATE_FACTOR):
            while True:
                trial = theta.copy()
                trial[INDEX[name]] += np.log(factor)
                lower = flt.run(trial).cost
                if not lower < cost - 1e-5:
                    break
                theta, cost = trial, lower
            if cost < start:  # back is higher
                break
        settled = {name} if cost < start else settled | {name}
    return theta

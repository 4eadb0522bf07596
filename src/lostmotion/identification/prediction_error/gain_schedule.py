"""Fits over the whole recording, with an observer gain that goes from high to low."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ..statistics.levenberg_marquardt import Fit, minimise
from .innovations import NAMES, Bandwidth, Predictor

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

#: Observer gains, from high to low, as fractions of the angular frequencies of pole (motor) and zero (load): the first
#: makes the cost smooth, the last ones let what the model leaves out bias the fit least. Calibrated on the virtual rigs
#: 1 and 2, ``benchmarks/calibrations.py``: inertias, stiffness, backlash and Coulomb torque are 0.20 % off as a median
#: and 1.0 % at most; 0.19 and 1.2 % with half of all gains; 0.58 and 1.5 % with double, and one interval of ten misses
#: the truth. (First chosen on finer plants whose list was not kept.)
LADDER = (Bandwidth(2.5, 0.38), Bandwidth(0.85, 0.11), Bandwidth(0.45, 0.06))

#: A lower gain is kept only while the innovations grow by no more than this factor (calibrated on the virtual rigs 1
#: to 20, which make them grow by 5 to 12 %). Above it the observer no longer follows at times, and friction and
#: inertia make up for that: in closed loop the load inertia was up to 2 % off.
LARGEST_GROWTH = 1.2

#: Windows (s) whose RMS exceeds so many times the median are down-weighted, by the square of the excess (calibrated on
#: the virtual rigs 1 to 20 under control), in at most so many fits in turn (numerics).
WINDOW, BURST, ROUNDS = 0.05, 1.5, 5

#: Steps at most for each gain of the schedule (numerics; three are usual).
ITERATIONS = 15

#: Nothing moves any more when all logarithms move by less than this (numerics: a tenth of a usual interval).
SETTLED = 2e-3

#: No parameter leaves its start by more than this factor (numerics).
FARTHEST = 20.0

#: A lag is fitted down to this fraction of a sample (numerics: far below what a recording can show).
SMALLEST_LAG = 0.05


@dataclass(frozen=True, eq=False)
class Box:
    """Bounds of the parameter vector."""

    lower: Array
    upper: Array

    @classmethod
    def around(cls, theta: Array, dt: float) -> Box:
        """Within the factor ``FARTHEST`` of theta, a lag at least ``SMALLEST_LAG`` samples; dt in s."""
        lower = theta - np.log(FARTHEST)
        lower[NAMES.index("lag")] = np.log((1.0 + SMALLEST_LAG) * dt)
        return cls(lower, theta + np.log(FARTHEST))


@dataclass(frozen=True, eq=False)
class Stage:
    """A fit over the whole recording, the gain at which it was made, and which parameters were free.

    ``unexcited`` are those that were put back to the nameplate; ``unknown`` (8,) is how far the others moved when one
    was left out of whose size the nameplate says nothing.
    """

    fit: Fit
    bandwidth: Bandwidth
    free: list[int]
    iterations: int
    unexcited: tuple[int, ...] = ()
    unknown: Array = field(default_factory=lambda: np.zeros(len(NAMES)))


def bandwidth_for(drivetrain: Drivetrain, rung: Bandwidth) -> Bandwidth:
    """A gain of the schedule in 1/s."""
    pole, zero = drivetrain.pole_frequency, drivetrain.zero_frequency
    return Bandwidth(rung.motor * 2.0 * np.pi * pole, rung.load * 2.0 * np.pi * zero)


def fit(
    predictor: Predictor,
    theta: Array,
    free: list[int],
    box: Box,
    bandwidth: Bandwidth,
    iterations: int = ITERATIONS,
) -> Fit:
    """Minimum over the free parameters, from theta on, within its bounds."""
    start = theta.copy()
    start[free] = np.clip(theta[free], box.lower[free], box.upper[free])
    return minimise(
        lambda t: predictor.residual(t, bandwidth),
        lambda t, r: predictor.jacobian(t, bandwidth, free, r),
        start, free, box.lower, box.upper, iterations,
    )  # fmt: skip


def fit_past_bursts(
    predictor: Predictor, theta: Array, free: list[int], box: Box, bandwidth: Bandwidth
) -> Fit:
    """As ``fit``, out of poor minima: there the observer loses the motion for moments, and the values make up for it.

    Iteratively reweighted fit, then one unweighted fit from there. The lower of both minima is returned.
    """
    first = fit(predictor, theta, free, box, bandwidth)
    if not free:
        return first
    theta, residual, done = first.theta, first.residual, first.iterations
    for _ in range(ROUNDS):
        found = _fit_weighted(predictor, theta, residual, free, box, bandwidth)
        moved = np.max(np.abs(found.theta[free] - theta[free]))
        theta, residual = found.theta, predictor.residual(found.theta, bandwidth)
        done += found.iterations
        if moved < SETTLED:
            break
    again = fit(predictor, theta, free, box, bandwidth)
    best = again if again.cost < first.cost else first
    return replace(best, iterations=done + again.iterations)


def _fit_weighted(
    predictor: Predictor, theta: Array, residual: Array, free: list[int], box: Box, bandwidth: Bandwidth
) -> Fit:
    """A fit with down-weighted windows of large innovations, (n,) or of several channels."""
    rows = max(1, int(WINDOW / predictor.dt)) * (residual.size // predictor.speed.size)
    starts = np.arange(0, residual.size, rows)
    size = np.sqrt(np.add.reduceat(residual**2, starts) / np.diff(starts, append=residual.size))
    usual = float(np.median(size[size > 0.0])) if np.any(size > 0.0) else 1.0
    weight = np.minimum(1.0, BURST * usual / np.maximum(size, 1e-300)) ** 2
    weights = np.repeat(weight, np.diff(starts, append=residual.size))
    return minimise(
        lambda t: weights * predictor.residual(t, bandwidth),
        lambda t, r: weights * predictor.jacobian(t, bandwidth, free, r / weights),
        theta, free, box.lower, box.upper, ITERATIONS,
    )  # fmt: skip


Fitting = Callable[[Predictor, Array, list[int], Box, Bandwidth], Fit]


def descent(
    predictor: Predictor,
    theta: Array,
    free: list[int],
    box: Box,
    say: Progress,
    later: Fitting = fit_past_bursts,
    gains: int | None = None,
) -> list[Stage]:
    """Fits with ever lower gain, each from the result of the one before; ``later`` is how from the second gain on.

    ``gains`` is how many of the schedule's, all without it.
    """
    stages: list[Stage] = []
    rungs = LADDER[:gains]
    for number, rung in enumerate(rungs):
        say(0.2 + 0.2 * number, f"fitting, gain {number + 1} of {len(rungs)}")
        bandwidth = bandwidth_for(predictor.drivetrain(theta), rung)
        found = (later if stages else fit)(predictor, theta, free, box, bandwidth)
        if stages and not found.cost < LARGEST_GROWTH**2 * stages[-1].fit.cost:
            break
        done = found.iterations + (stages[-1].iterations if stages else 0)
        stages.append(Stage(found, bandwidth, free, done))
        theta = found.theta
    return stages

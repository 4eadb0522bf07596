"""Fits over the whole recording, with an observer gain that goes from high to low."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from .gauss_newton import Fit, minimise
from .predictor import NAMES, Bandwidth, Predictor

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

#: Observer gains, from high to low, as fractions of the angular frequencies of pole (motor) and zero
#: (load). Chosen on finer plants: the first makes the cost smooth, the last ones let what the model leaves
#: out (a mode at seven times the pole) bias the fit least.
LADDER = (Bandwidth(2.5, 0.38), Bandwidth(0.85, 0.11), Bandwidth(0.45, 0.06))

#: A lower gain is kept only while the innovations grow by no more than this factor (chosen). Above it the
#: observer no longer follows, because of disturbances or of a rugged cost.
LARGEST_GROWTH = 1.5

#: The descent is repeated until the sum of squares no longer falls below this fraction, at most so many times (chosen:
#: on finer plants one fit in ten to twenty is caught in a poor minimum, and leaves it at high gain).
WORTHWHILE, DESCENTS = 0.99, 4

#: Steps at most for each gain of the ladder (chosen; three are usual).
ITERATIONS = 15

#: No parameter leaves its start by more than this factor (chosen).
FARTHEST = 20.0

#: A lag is fitted down to this fraction of a sample (chosen: far below what can be told from none).
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

    ``unexcited`` are those that were put back to the nameplate.
    """

    fit: Fit
    bandwidth: Bandwidth
    free: list[int]
    iterations: int
    unexcited: tuple[int, ...] = ()


def bandwidth_for(drivetrain: Drivetrain, rung: Bandwidth) -> Bandwidth:
    """A rung of the ladder in 1/s."""
    pole, zero = drivetrain.pole_frequency, drivetrain.zero_frequency
    return Bandwidth(rung.motor * 2.0 * np.pi * pole, rung.load * 2.0 * np.pi * zero)


def fit(predictor: Predictor, theta: Array, free: list[int], box: Box, bandwidth: Bandwidth) -> Fit:
    """Minimum over the free parameters, from theta on, within the box."""
    start = theta.copy()
    start[free] = np.clip(theta[free], box.lower[free], box.upper[free])
    return minimise(
        lambda t: predictor.residual(t, bandwidth),
        lambda t, r: predictor.jacobian(t, bandwidth, free, r),
        start, free, box.lower, box.upper, ITERATIONS,
    )  # fmt: skip


def descent(
    predictor: Predictor,
    theta: Array,
    free: list[int],
    box: Box,
    say: Progress,
    rungs: Sequence[Bandwidth] = LADDER,
) -> list[Stage]:
    """Fits with ever lower gain, each from the result of the one before."""
    stages: list[Stage] = []
    for number, rung in enumerate(rungs):
        say(0.2 + 0.2 * number, f"fitting, gain {number + 1} of {len(rungs)}")
        bandwidth = bandwidth_for(predictor.drivetrain(theta), rung)
        found = fit(predictor, theta, free, box, bandwidth)
        if stages and not found.cost < LARGEST_GROWTH**2 * stages[-1].fit.cost:
            break
        done = found.iterations + (stages[-1].iterations if stages else 0)
        stages.append(Stage(found, bandwidth, free, done))
        theta = found.theta
    return stages


def descend(predictor: Predictor, theta: Array, free: list[int], box: Box, say: Progress) -> Stage:
    """The last fit of a descent."""
    return descent(predictor, theta, free, box, say)[-1]


def descend_again(predictor: Predictor, theta: Array, free: list[int], box: Box, say: Progress) -> Stage:
    """Descend, then from the high gain again: a minimum that only the low gain has is left this way."""
    stage = descend(predictor, theta, free, box, say)
    for _ in range(DESCENTS - 1):
        other = descend(predictor, stage.fit.theta, free, box, lambda fraction, text: None)
        if not other.fit.cost < WORTHWHILE * stage.fit.cost:
            break
        stage = replace(other, iterations=stage.iterations + other.iterations)
    return stage

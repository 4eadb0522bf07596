"""The set-point that drives a signal furthest: how near a bound of its peak comes to what really happens."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...simulation import simulate
from ...systems import DiscreteSystem

Array = NDArray[np.float64]
Switches = NDArray[np.int64]

#: Length of a simulation, s, and switches of the set-point within it (option: longer and more change the peaks of Table
#: I by less than 1 %).
DURATION, SWITCHES = 0.3, 16

#: Half periods of the square waves that searches start from, the range of those of the further ones, which start at
#: random, and the first step of the search, all over the duration (option).
HALF_PERIODS, SPACING, STEP = (0.025, 0.05, 0.125), (0.005, 0.05), 0.02

#: Gain below which a step is no better, and what is left after the last switch, over the duration (option).
LEAST_GAIN, REST = 1e-4, 0.002


@dataclass(frozen=True, eq=False)
class WorstReference:
    """The worst set-point that was found: ``reference`` (samples,) in rad/s, and the ``peak`` of ``signal``."""

    signal: str
    peak: float
    reference: Array


@checks_arguments
def worst_reference(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    reference: float,
    signal: str,
    *,
    delay: int = 0,
    starts: int = 3,
    duration: float = DURATION,
    seed: int = 0,
) -> WorstReference:
    """The set-point within ±``reference`` (rad/s) that brings ``signal`` furthest from rest, by local search.

    A linear loop is worst where the set-point is always at one of its limits; what is searched is when it switches. One
    switch, or all before it, move as long as the peak grows, in steps that are halved.

    Parameters
    ----------
    drivetrain : Drivetrain
    law : DiscreteSystem
    reference : float, rad/s
    signal : str
        Of the simulation's recording: twist, speed_motor, speed_load, torque_motor.
    delay : int
        Computing delay, samples; as for ``peak_bounds``.
    starts : int
        Searches, the first from the worst set-point of a linear loop with the same step response; the best is returned.
    duration : float, s
        Of a simulation; some slowest time constants of the loop.
    seed : int

    Raises
    ------
    InvalidInput
        For a set-point limit or a number of starts that is not positive, and a duration of less than two samples for
        each switch.
    """
    if not reference > 0.0 or starts < 1:
        raise InvalidInput(
            "worst_reference", f"{reference} rad/s, {starts} starts", "positive", "Check both."
        )
    samples = round(duration / law.dt)
    if samples < 2 * SWITCHES:
        raise InvalidInput(
            "worst_reference.duration",
            f"{duration} s",
            f"{2 * SWITCHES} samples or more",
            "Take some tenths of a second.",
        )
    rng = np.random.default_rng(seed)

    def wave(switches: Switches) -> Array:
        """It changes its sign at each switch."""
        turned = np.zeros(samples)
        np.add.at(turned, switches[(switches > 0) & (switches < samples)], 1.0)
        return np.asarray(reference * (1.0 - 2.0 * (np.cumsum(turned) % 2.0)))

    def run(given: Array) -> Array:
        return simulate(drivetrain, law=law, dt=law.dt, speed_reference=given, delay=delay)[signal]

    def peak(switches: Switches) -> float:
        return float(np.max(np.abs(run(wave(switches)))))

    firsts = [_linear(run(np.full(samples, reference)))]
    firsts += [_first(samples, start, rng) for start in range(starts - 1)]
    found = [_climbed(peak, first, round(STEP * samples)) for first in firsts]
    best, switches = max(found, key=lambda each: each[0])
    return WorstReference(signal, best, wave(switches))


def _linear(step: Array) -> Switches:
    """The switches that are worst for the linear loop of which this is the step response: it turns there, counted from
    the end."""
    turns = 1 + np.flatnonzero(np.diff(np.sign(np.diff(step))))
    return np.asarray(step.size - turns[:SWITCHES], dtype=np.int64)


def _first(samples: int, start: int, rng: np.random.Generator) -> Switches:
    """Switches of a square wave, or at random; the peak is to come at the end."""
    shares = HALF_PERIODS[start : start + 1] * SWITCHES or rng.uniform(*SPACING, SWITCHES)
    after = np.cumsum(np.maximum(1, np.round(np.multiply(shares, samples))).astype(int))
    return np.asarray(after - after[-1] + round((1.0 - REST) * samples))


def _climbed(peak: Callable[[Switches], float], switches: Switches, step: int) -> tuple[float, Switches]:
    """The largest peak, and its switches, that steps of one switch, or of all up to it, lead to."""
    found = peak(switches)
    while step >= 1:
        better = False
        for i, sign, alone in np.ndindex(switches.size, 2, 2):
            moved = switches.copy()
            moved[i * alone : i + 1] += step * (2 * sign - 1)
            value = peak(moved)
            if value > found * (1.0 + LEAST_GAIN):
                found, switches, better = value, moved, True
        step = step if better else step // 2
    return found, switches

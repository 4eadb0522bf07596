"""Where describing functions expect limit cycles: the growth of an oscillation over its amplitude."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem
from ..linear_loop import exponential
from ..lure import LureLoop, lure_loop
from ..rational import Matrix
from .describing_functions import LEAST, CurveValues, describing_function

Array = NDArray[np.float64]

#: Amplitudes of the load speed that are tried, over the set-point's size or 0.01 rad/s (option: from well inside a gap
#: to far beyond the set-point), and how many.
SMALLEST, LARGEST, AMPLITUDES = 0.1, 100.0, 19
#: Rounds of gains and mode shape, share of each new gain, and change at which they have settled (numerics).
ROUNDS, SHARE, SETTLED = 50, 0.4, 3e-3
#: Distance from 1 up to which an eigenvalue over a sample is a drift, as of the twist in the open gap (numerics).
DRIFT = 1e-9


@dataclass(frozen=True)
class Harmonic:
    """An oscillation that describing functions expect: load speed (rad/s), frequency (Hz), whether it is stable."""

    amplitude: float
    frequency: float
    is_stable: bool


@dataclass(frozen=True, eq=False)
class HarmonicBalance:
    """Growth of an oscillation over its amplitude.

    Parameters
    ----------
    amplitude : (a,) array, rad/s
        Of the load speed.
    growth : (a,) array, 1/s
        Of the least damped motion with that amplitude; NaN where gains and mode do not settle.
    frequency : (a,) array, Hz
        Of that motion; 0 where it grows or decays without swinging.
    """

    amplitude: Array
    growth: Array
    frequency: Array

    @property
    def expected(self) -> tuple[Harmonic, ...]:
        """Where the growth changes its sign; where it falls, the limit cycle is stable."""
        found = []
        known = np.flatnonzero(np.isfinite(self.growth))
        for i, j in zip(known, known[1:], strict=False):
            first, last = self.growth[i], self.growth[j]
            if first * last < 0.0:
                part = first / (first - last)
                between = np.log(self.amplitude[i]) * (1.0 - part) + np.log(self.amplitude[j]) * part
                frequency = (1.0 - part) * self.frequency[i] + part * self.frequency[j]
                found.append(Harmonic(float(np.exp(between)), float(frequency), bool(first > last)))
        return tuple(found)


@checks_arguments
def harmonic_balance(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    *,
    reference: float,
    torque_load: float = 0.0,
    delay: int = 0,
    amplitudes: Sequence[float] | None = None,
) -> HarmonicBalance:
    """The growth of the least damped oscillation around a set-point, with every curve as its describing function.

    A map, not a result: harmonics are left out, and sticking too, so amplitudes and even existence can be wrong where
    the load sticks for a large part of the period. ``limit_cycle`` says what is there.

    Parameters
    ----------
    drivetrain : Drivetrain
        As for ``prove_running``, with Stribeck friction; a breakaway level is left out.
    law : DiscreteSystem
    reference : float, rad/s
    torque_load : float, Nm
    delay : int
        Computing delay, samples.
    amplitudes : sequence of float, rad/s, optional
        Of the load speed, rising.

    Raises
    ------
    InvalidInput
        As ``lure.lure_loop``.
    """
    loop = _Loop(lure_loop(drivetrain, law, delay=delay, stribeck=True), float(reference), float(torque_load))
    size = max(abs(reference), 0.01)
    tried = (
        np.geomspace(SMALLEST * size, LARGEST * size, AMPLITUDES)
        if amplitudes is None
        else np.asarray(amplitudes)
    )
    if tried.ndim != 1 or not tried.size or not np.all((tried > 0.0) & np.isfinite(tried)):
        raise InvalidInput(
            "harmonic_balance.amplitudes", repr(amplitudes), "positive numbers in rad/s", "Leave it out."
        )
    found = [loop.growth(float(amplitude)) for amplitude in tried]
    return HarmonicBalance(tried, np.array([g for g, _ in found]), np.array([f for _, f in found]))


class _Loop:
    """The loop in floats, with the state of the iteration: it goes on from the last amplitude."""

    def __init__(self, loop: LureLoop, reference: float, torque_load: float) -> None:
        self.A, self.E, self.Z, self.L = (_floats(m) for m in (loop.A, loop.E, loop.Z, loop.L))
        self.S, self.S_w, self.S_v, self.R = (_floats(m) for m in (loop.S, loop.S_w, loop.S_v, loop.R))
        self.N, self.N_w, self.N_v, self.M = (_floats(m) for m in (loop.N, loop.N_w, loop.N_v, loop.M))
        self.curves = [CurveValues.of(curve) for curve in (*loop.plant_curves, *loop.law_curves)]
        self.dt, self.plant = float(loop.dt), loop.plant_size
        self.speed = loop.states.index("speed_load")
        self.reference, self.torque_load = reference, torque_load
        self.means = self._rest(
            np.zeros(len(self.curves)), np.zeros(len(self.curves)), np.zeros(len(self.curves))
        )
        self.sizes = np.zeros(len(self.curves))

    def growth(self, amplitude: float) -> tuple[float, float]:
        """Growth (1/s) and frequency (Hz) of an oscillation of the load speed."""
        sizes = self.sizes if np.any(self.sizes) else np.full(len(self.curves), amplitude)
        for _ in range(ROUNDS):
            each = [
                describing_function(curve, mean, size)
                for curve, mean, size in zip(self.curves, self.means, sizes, strict=True)
            ]
            outputs, gains, slopes = (np.array(column) for column in zip(*each, strict=True))
            mode = self._mode(gains)
            if mode is None:
                return math.nan, math.nan
            value, shape = mode
            new = np.abs(shape) * amplitude
            unsettled = np.any(np.abs(new - sizes) > SETTLED * new + LEAST * (1.0 + np.abs(self.means)))
            self.means += SHARE * (self._rest(outputs, slopes, self.means) - self.means)
            sizes = sizes + SHARE * (new - sizes)
            rate, frequency = math.log(abs(value)) / self.dt, abs(np.angle(value)) / (2.0 * math.pi * self.dt)
            if not unsettled:
                self.sizes = sizes
                return rate, frequency
        return math.nan, math.nan

    def _mode(self, gains: Array) -> tuple[complex, Array] | None:
        """Eigenvalue over a sample of the least damped motion, and the curves' arguments over the load's speed."""
        p = self.Z.shape[0]
        w = gains[:p, np.newaxis] * self.Z
        of_law = gains[p:, np.newaxis]
        s = np.linalg.solve(np.eye(of_law.size) - self.N_v * of_law.T, self.N + self.N_w @ w)
        step = (self.S + self.S_w @ w + self.S_v @ (of_law * s)) @ exponential(
            (self.A + self.E @ w) * self.dt
        )
        values, vectors = np.linalg.eig(step)
        moves = (np.abs(values - 1.0) > DRIFT) & (np.abs(vectors[self.speed]) > DRIFT)
        if not np.any(moves):
            return None
        worst = int(np.argmax(np.where(moves, np.abs(values), -1.0)))
        shape = vectors[:, worst] / vectors[self.speed, worst]
        return complex(values[worst]), np.concatenate([self.Z @ shape, s @ shape])

    def _rest(self, outputs: Array, slopes: Array, means: Array) -> Array:
        """Means of the curves' arguments where the loop rests, each curve a line through its mean output."""
        n, p, q = self.A.shape[0], self.Z.shape[0], self.N.shape[0]
        flow = np.hstack([self.A, self.E, np.zeros((n, q))])[: self.plant]
        jump = np.hstack([self.S - np.eye(n), self.S_w, self.S_v])[self.plant :]
        arguments = np.zeros((p + q, n + p + q))
        arguments[:p, :n] = self.Z
        arguments[p:] = np.hstack([self.N, self.N_w, self.N_v])
        offset = np.concatenate([np.zeros(p), self.M[:, 0] * self.reference])
        curves = -slopes[:, np.newaxis] * arguments
        curves[:, n:] += np.eye(p + q)
        rows = np.vstack([flow, jump, curves])
        right = np.concatenate([
            -self.L[: self.plant, 0] * self.torque_load, -self.R[self.plant :, 0] * self.reference,
            outputs - slopes * (means - offset),
        ])  # fmt: skip
        return np.asarray(arguments @ np.linalg.lstsq(rows, right, rcond=None)[0] + offset)


def _floats(matrix: Matrix) -> Array:
    return np.asarray(matrix, dtype=float)

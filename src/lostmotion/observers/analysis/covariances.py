"""Covariances of process and sensors from a recording: the likelihood of the observer's own innovations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...recording import Recording
from ...systems import DiscreteSystem
from ..arguments import flag, sensors, two_masses
from ..fixed_gain.kalman import (
    MEASUREMENT_COVARIANCE,
    PROCESS_COVARIANCE,
    covariances_of,
    expected_innovation,
    kalman,
    predictor_gain,
)
from ..fixed_gain.sampled_model import SampledModel, sampled_model
from ..model import SENSORS

Array = NDArray[np.float64]

#: States whose process covariance is searched for. The twist follows from the speeds, so it is left at zero.
SEARCHED = ("speed_motor", "speed_load")

#: Settling time before the innovations are used, s (option: six time constants of Observer 1's slow pole on the paper's
#: rig).
SETTLING = 0.3

#: Search range: this factor around the start, either way (numerics).
FARTHEST = 1e6


@dataclass(frozen=True, eq=False)
class Covariances:
    """Covariances found, as ``kalman`` takes them, and how well they predict.

    Parameters
    ----------
    process, measurement : mapping of name → continuous density
        Arguments ``process_covariance`` and ``measurement_covariance`` of ``kalman``.
    gain : (n_states, n_measured) array
        Predictor gain of the observer made with them.
    innovation_rms, start_rms : mapping of measured signal → float
        RMS of the innovations of the result and of the start, in the signal's unit.
    sensitivity : mapping of name → float
        Curvature of the cost by the logarithm of each entry; 0: it has no influence.
    converged : bool
    """

    process: Mapping[str, float]
    measurement: Mapping[str, float]
    gain: Array
    innovation_rms: Mapping[str, float]
    start_rms: Mapping[str, float]
    sensitivity: Mapping[str, float]
    converged: bool

    def observer(
        self, drivetrain: Drivetrain, *, dt: float, speed_from_counts: bool = False
    ) -> DiscreteSystem:
        """The observer with these covariances."""
        return kalman(
            drivetrain, measured=tuple(self.measurement), dt=dt, process_covariance=self.process,
            measurement_covariance=self.measurement, speed_from_counts=speed_from_counts,
        )  # fmt: skip


def covariances(
    recording: Recording,
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    searched: Sequence[str] = SEARCHED,
    speed_from_counts: bool | None = None,
) -> Covariances:
    """Find the covariances under which the recording is most likely.

    With Gaussian innovations e of covariance S, the log-likelihood is −N/2·(log det S + tr S⁻¹·mean(e eᵀ)). Only
    ratios of the covariances enter the gain, so S is eliminated, and what is minimised over their logarithms is::

        log det mean(e eᵀ)

    The common scale then follows from S. The search is Nelder–Mead, because the gap makes the cost rugged.

    Parameters
    ----------
    recording : Recording
        torque_motor and the measured signals; best in normal operation of the drive.
    drivetrain : Drivetrain
        Identified before; its errors act as process noise, as they do in an observer.
    measured : sequence of str
    searched : sequence of str
        States whose process covariance is searched for; all others get 0.
    speed_from_counts : bool, optional
        As in ``kalman``; default: ``recording.meta["speed_from_counts"]``.

    Returns
    -------
    Covariances

    Raises
    ------
    InvalidInput
        For a missing signal, unknown names, and a recording that is too short.

    Notes
    -----
    Innovations likelihood: Schweppe 1965, IEEE Trans. Information Theory 11, 61–70; determinant criterion: Ljung 1999,
    System Identification, section 7.4.
    """
    from scipy.optimize import minimize

    drivetrain, measured = two_masses(drivetrain), sensors(measured, SENSORS)
    if speed_from_counts is None:
        speed_from_counts = bool(recording.meta.get("speed_from_counts", False)) and "speed_motor" in measured
    flag("speed_from_counts", speed_from_counts)
    problem = _Problem(recording, drivetrain, measured, tuple(searched), speed_from_counts)
    start = problem.start()
    limit = np.log(FARTHEST)
    options: Any = {
        "xatol": 0.05, "fatol": 1e-5, "maxfev": 60 * start.size, "initial_simplex": _simplex(start),
    }  # fmt: skip

    def cost(theta: Array) -> float:
        return problem.cost(np.clip(theta, start - limit, start + limit))

    found: Any = minimize(cost, start, method="Nelder-Mead", options=options)
    theta = np.clip(found.x, start - limit, start + limit)
    return problem.result(theta, start, bool(found.success))


def _simplex(start: Array) -> Array:
    """Start simplex that spans a factor of twenty in every direction."""
    return np.vstack([start, start + np.log(20.0) * np.eye(start.size)])


class _Problem:
    """Innovations as a function of the logarithms of the covariances; that of the first sensor is fixed."""

    def __init__(
        self, recording: Recording, drivetrain: Drivetrain, measured: tuple[str, ...], searched: tuple[str, ...],
        speed_from_counts: bool,
    ) -> None:  # fmt: skip
        unknown = sorted(set(searched) - set(PROCESS_COVARIANCE))
        if unknown or not searched or len(set(searched)) < len(searched):
            raise InvalidInput(
                "covariances.searched",
                repr(searched),
                f"names out of {tuple(PROCESS_COVARIANCE)}",
                "Check them.",
            )
        self.data = recording.only("torque_motor", *measured)
        self.skip = round(SETTLING / recording.dt)
        if len(recording) < 4 * self.skip:
            raise InvalidInput(
                "covariances.recording",
                f"{len(recording)} rows",
                f"at least {4 * self.skip}",
                "Record longer.",
            )
        self.drivetrain, self.measured, self.searched = drivetrain, measured, searched
        self.speed_from_counts = speed_from_counts

    def start(self) -> Array:
        process = [PROCESS_COVARIANCE[name] or 1.0 for name in self.searched]
        return np.log([*process, *(MEASUREMENT_COVARIANCE[name] for name in self.measured[1:])])

    def _named(self, theta: Array, scale: float = 1.0) -> tuple[dict[str, float], dict[str, float]]:
        values = scale * np.exp(theta)
        n = len(self.searched)
        process = {"twist": 0.0, "speed_motor": 0.0, "speed_load": 0.0}
        process |= {name: float(v) for name, v in zip(self.searched, values[:n], strict=True)}
        measurement = {self.measured[0]: scale * MEASUREMENT_COVARIANCE[self.measured[0]]}
        measurement |= {name: float(v) for name, v in zip(self.measured[1:], values[n:], strict=True)}
        return process, measurement

    def _design(self, theta: Array) -> tuple[SampledModel, Array, Array]:
        design = sampled_model(
            self.drivetrain,
            self.measured,
            self.data.dt,
            self.speed_from_counts,
            "torque_load" in self.searched,
        )
        return (design, *covariances_of(design, *self._named(theta)))

    def innovations(self, theta: Array) -> Array:
        """(n, n_measured), without the settling time."""
        design, q, r = self._design(theta)
        gain = predictor_gain(design, design.model.A, q, r)
        run = design.assembly.system(self.measured, gain, design.c, innovation=True).run(self.data)
        return np.column_stack([run[f"innovation_{s}"][self.skip :] for s in self.measured])

    def cost(self, theta: Array) -> float:
        try:
            e = self.innovations(theta)
        except InvalidInput:
            return 1e6
        _, cost = np.linalg.slogdet(e.T @ e / len(e))
        return float(cost) if np.isfinite(cost) else 1e6

    def result(self, theta: Array, start: Array, converged: bool) -> Covariances:
        e, before = self.innovations(theta), self.innovations(start)
        design, q, r = self._design(theta)
        gain, expected = predictor_gain(design, design.model.A, q, r), expected_innovation(design, q, r)
        # S as the Riccati equation expects it, against the one measured: one factor on all covariances.
        scale = float(np.trace(np.linalg.solve(expected, e.T @ e / len(e)))) / len(self.measured)
        process, measurement = self._named(theta, scale)
        names = (*self.searched, *self.measured[1:])
        middle, step = self.cost(theta), np.log(2.0)
        bends = [
            (self.cost(theta + step * row) + self.cost(theta - step * row) - 2.0 * middle) / step**2
            for row in np.eye(theta.size)
        ]
        return Covariances(
            process=process,
            measurement=measurement,
            gain=gain,
            innovation_rms=dict(zip(self.measured, np.sqrt(np.mean(e**2, axis=0)).tolist(), strict=True)),
            start_rms=dict(zip(self.measured, np.sqrt(np.mean(before**2, axis=0)).tolist(), strict=True)),
            sensitivity={n: max(float(b), 0.0) for n, b in zip(names, bends, strict=True)},
            converged=converged,
        )

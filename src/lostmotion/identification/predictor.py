"""Innovations of the project's own observer as a function of the drivetrain's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..observers import kalman
from ..systems import DiscreteSystem

Array = NDArray[np.float64]

#: Identified parameters, in the order of every vector and matrix of this folder.
NAMES = ("inertia_motor", "inertia_load", "stiffness", "damping", "backlash", "coulomb", "viscous", "lag")

#: The kernel runs without the interpreter's lock: two threads halve the time (chosen for two cores).
THREADS = 2

_STATES = ("twist", "speed_motor", "speed_load", "torque_actuator", "speed_motor_previous")


@dataclass(frozen=True)
class Bandwidth:
    """Observer gain by the speed of its correction of motor and load, 1/s.

    With process torque noise of density q and measurement noise of density r, a lone inertia J has the Kalman
    gain √(q/r)/J: this number. It therefore stands for the two noise parameters.
    """

    motor: float
    load: float


@dataclass(frozen=True, eq=False)
class Predictor:
    """Motor torque and motor speed on one raster, and how the speed was measured.

    Parameters
    ----------
    torque, speed : (n,) arrays, Nm and rad/s
    dt : float, s
    count_averaged : bool
        The speed is a mean over the sample before.
    base : Drivetrain
        Two masses; what is not identified (friction of the motor) stays as it is here.
    skip : int
        First innovations that count as zero, while the observer settles.
    """

    torque: Array
    speed: Array
    dt: float
    count_averaged: bool
    base: Drivetrain
    skip: int
    _pool: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(THREADS))

    def part(self, rows: slice) -> Predictor:
        """The same over some rows."""
        torque, speed = np.ascontiguousarray(self.torque[rows]), np.ascontiguousarray(self.speed[rows])
        return Predictor(torque, speed, self.dt, self.count_averaged, self.base, self.skip, self._pool)

    def drivetrain(self, theta: Array) -> Drivetrain:
        """Two-mass drivetrain of a parameter vector (see ``to_theta``)."""
        return self.base.with_parameters(**dict(zip(NAMES, from_theta(theta, self.dt), strict=True)))

    def observer(self, theta: Array, bandwidth: Bandwidth) -> DiscreteSystem:
        """The observer whose innovations are minimised."""
        process = {
            "twist": 0.0, "speed_motor": bandwidth.motor**2, "speed_load": bandwidth.load**2
        }  # fmt: skip
        return kalman(
            self.drivetrain(theta), dt=self.dt, process_covariance=process,
            measurement_covariance={"speed_motor": 1.0}, count_averaged=self.count_averaged,
        )  # fmt: skip

    def residual(self, theta: Array, bandwidth: Bandwidth) -> Array:
        """(n,) innovations, rad/s; the first ``skip`` are zero."""
        from ..kernels.prediction_error import innovations

        tables = _kernel_tables(self.observer(theta, bandwidth), self.drivetrain(theta), self.count_averaged)
        first = self.speed[0]
        state = np.array([0.0, first, first, self.torque[0], first])
        residual = np.empty(self.speed.size)
        innovations(*tables, state, self.torque, self.speed, residual)
        residual[: self.skip] = 0.0
        return residual

    def residuals(self, thetas: Sequence[Array], bandwidth: Bandwidth) -> list[Array]:
        """Innovations for several parameter vectors, on two threads."""
        return list(self._pool.map(lambda theta: self.residual(theta, bandwidth), thetas))

    def reversals(self, theta: Array, bandwidth: Bandwidth) -> int:
        """How often the estimated shaft torque changes its sign."""
        run = self.observer(theta, bandwidth).run({"torque_motor": self.torque, "speed_motor": self.speed})
        side = np.sign(run["torque_shaft_estimated"][self.skip :])
        return int(np.count_nonzero(np.diff(side[side != 0.0])))

    def jacobian(self, theta: Array, bandwidth: Bandwidth, free: Sequence[int], residual: Array) -> Array:
        """(len(free), n) forward differences of the innovations.

        A step of 1e-4 in the logarithm is far above rounding, and moves a gap by a hundredth of what it is known.
        """
        step = 1e-4
        moved = [theta + step * np.eye(1, theta.size, i)[0] for i in free]
        return np.array([(r - residual) / step for r in self.residuals(moved, bandwidth)])


def to_theta(values: Sequence[float], dt: float) -> Array:
    """Logarithms of the parameters; of lag + dt for the lag, which may be zero."""
    theta = np.array(values, dtype=float)
    theta[-1] += dt
    return np.log(theta)


def from_theta(theta: Array, dt: float) -> Array:
    """Parameters in the order of NAMES."""
    values = np.exp(theta)
    values[-1] = max(values[-1] - dt, 0.0)
    return values


def _kernel_tables(
    system: DiscreteSystem, drivetrain: Drivetrain, count_averaged: bool
) -> tuple[Array, Array, Array, Array, Array, float, Array, Array]:
    """The matrices of an observer in the layout of the kernel; what it does not have is zero there."""
    known = [i for i, name in enumerate(_STATES) if name in system.states]
    own = [system.states.index(_STATES[i]) for i in known]
    measured = np.array([0.0, 0.5, 0.0, 0.0, 0.5]) if count_averaged else np.eye(1, 5, 1)[0]
    phi, torque_gain, gain, curve_gain = np.zeros((5, 5)), np.zeros(5), np.zeros(5), np.zeros((5, 3))
    torque_gain[known], gain[known] = system.B[own].T
    phi[np.ix_(known, known)] = system.A[np.ix_(own, own)]
    phi += np.outer(gain, measured)
    if "torque_actuator" in system.states:
        gain_actuator = phi[3, 3]
        phi[3] = 0.0
        phi[3, 3] = gain_actuator
    limits, rest, lead = np.zeros(3), np.zeros(2), 0.0
    for column, curve in _curves(drivetrain):
        curve_gain[known, column] = system.E[own, curve]
        limits[column] = system.curves[curve].points[-1][1]
        if column == 0:
            lead = float(system.F[curve, 1])
        else:
            (z0, w0), (z1, w1) = system.curves[curve].points
            rest[column - 1] = (w1 - w0) / (z1 - z0)
    return phi, torque_gain, curve_gain, gain, measured, lead, limits, rest


def _curves(drivetrain: Drivetrain) -> list[tuple[int, int]]:
    """(column of the kernel, curve of the observer) for gap, friction of the motor, friction of the load."""
    pairs, count = [], 0
    if drivetrain.shaft.has_backlash:
        pairs.append((0, 0))
        count = 3 if drivetrain.contact != "dead_zone" and drivetrain.damping > 0.0 else 2
    for column, level in ((1, drivetrain.coulomb_motor), (2, drivetrain.coulomb)):
        if level > 0.0:
            pairs.append((column, count))
            count += 1
    return pairs

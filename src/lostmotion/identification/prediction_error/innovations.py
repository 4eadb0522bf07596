"""Innovations of the project's own observer as a function of the drivetrain's parameters."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...observers import kalman
from ...systems import DiscreteSystem

Array = NDArray[np.float64]

#: Identified parameters, in the order of every vector and matrix of this folder.
NAMES = ("inertia_motor", "inertia_load", "stiffness", "damping", "backlash", "coulomb", "viscous", "lag")

#: The kernel runs without the interpreter's lock: two threads halve the time (option: for two cores).
THREADS = 2


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
    """Motor torque and motor speed on one raster, in one or more segments, and how the speed was measured.

    Parameters
    ----------
    torque, speed : (n,) arrays, Nm and rad/s
    dt : float, s
    speed_from_counts : bool
        The speed is a mean over the sample before.
    base : Drivetrain
        Two masses; what is not identified (friction of the motor) stays as it is here.
    skip : int
        First innovations that count as zero, while the observer settles.
    bounds : tuple of int
        First row of each segment, and the number of rows; default: one segment.
    skip_later : int
        The same as ``skip`` for every further segment, which may begin in the middle of a motion.
    joined : bool
        Each row stands for several recorded ones.
    """

    torque: Array
    speed: Array
    dt: float
    speed_from_counts: bool
    base: Drivetrain
    skip: int
    bounds: tuple[int, ...] = ()
    skip_later: int = 0
    joined: bool = False
    _pool: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(THREADS))

    def __post_init__(self) -> None:
        object.__setattr__(self, "bounds", self.bounds or (0, self.torque.size))

    @property
    def joint_piece(self) -> tuple[float, float] | None:
        """Share of the motor's inertia on the shaft, and of the shaft's compliance before it; None: two masses."""
        return None

    @property
    def replicable(self) -> bool:
        """Whether all that is measured can be simulated anew from the motor torque."""
        return True

    @property
    def pieces(self) -> list[slice]:
        """Rows of each segment."""
        return [slice(a, b) for a, b in zip(self.bounds, self.bounds[1:], strict=False)]

    def part(self, rows: slice) -> Predictor:
        """The same over some rows."""
        torque, speed = np.ascontiguousarray(self.torque[rows]), np.ascontiguousarray(self.speed[rows])
        inner = [b - rows.start for b in self.bounds if rows.start < b < rows.stop]
        bounds = (0, *inner, torque.size)
        return replace(self, torque=torque, speed=speed, bounds=bounds)

    def speed_residual(self, residual: Array) -> Array:
        """(n,) innovations of the motor speed out of a residual, rad/s."""
        return residual

    def noise_levels(self, residual: Array) -> dict[str, float]:
        """Rms of each channel's innovations in its own unit."""
        return {"speed_motor": float(np.sqrt(np.mean(residual[self.settled()] ** 2)))}

    def settling(self) -> list[slice]:
        """Rows of each segment in which the observer settles; they do not count."""
        skips = [self.skip] + [self.skip_later] * (len(self.bounds) - 2)
        return [
            slice(piece.start, min(piece.start + skip, piece.stop))
            for piece, skip in zip(self.pieces, skips, strict=True)
        ]

    def settled(self) -> NDArray[np.bool_]:
        """(n,) rows that count."""
        rows = np.ones(self.torque.size, dtype=bool)
        for settling in self.settling():
            rows[settling] = False
        return rows

    def drivetrain(self, theta: Array) -> Drivetrain:
        """Two-mass drivetrain of a parameter vector (see ``to_theta``)."""
        return self.base.with_parameters(**dict(zip(NAMES, from_theta(theta, self.dt), strict=True)))

    def observer(self, theta: Array, bandwidth: Bandwidth) -> DiscreteSystem:
        """The observer whose innovations are minimised, as ``observers.kalman`` makes it."""
        process = {
            "twist": 0.0, "speed_motor": bandwidth.motor**2, "speed_load": bandwidth.load**2
        }  # fmt: skip
        return kalman(
            self.drivetrain(theta), dt=self.dt, process_covariance=process,
            measurement_covariance={"speed_motor": 1.0}, speed_from_counts=self.speed_from_counts,
        )  # fmt: skip

    def residual(self, theta: Array, bandwidth: Bandwidth) -> Array:
        """(n,) innovations, rad/s; the first ``skip`` are zero."""
        return np.asarray(self._innovations(np.atleast_2d(theta), bandwidth)[0])

    def residuals(self, thetas: Array, bandwidth: Bandwidth) -> Array:
        """(m, n) innovations for m parameter vectors, on two threads."""
        halves = np.array_split(np.asarray(thetas), THREADS)
        parts = self._pool.map(lambda half: self._innovations(half, bandwidth), halves)
        return np.concatenate(list(parts))

    def _innovations(self, thetas: Array, bandwidth: Bandwidth) -> Array:
        from ...kernels.innovations.two_mass import innovations

        gains = (bandwidth.motor, bandwidth.load)
        bounds = np.array(self.bounds, dtype=np.int64)
        residual = innovations(
            self._parameters(thetas), gains, self.dt, self.speed_from_counts, bounds, self.torque, self.speed
        )
        for settling in self.settling():
            residual[:, settling] = 0.0
        return np.asarray(residual)

    def _parameters(self, thetas: Array) -> Array:
        """(m, 10) parameters in the kernels' order."""
        parameters = np.empty((len(thetas), 10))
        for row, theta in zip(parameters, thetas, strict=True):
            values = from_theta(theta, self.dt)
            row[:7], row[9] = values[:7], values[7]
        parameters[:, 7:9] = self.base.coulomb_motor, self.base.viscous_motor
        return parameters

    def jacobian(self, theta: Array, bandwidth: Bandwidth, free: list[int], residual: Array) -> Array:
        """(len(free), n) forward differences of the innovations.

        A step of 1e-4 in the logarithm is far above rounding, and moves a gap by a hundredth of what it is
        known.
        """
        step = 1e-4
        moved = self.residuals(theta + step * np.eye(theta.size)[free], bandwidth)
        moved -= residual
        moved /= step
        return moved


def to_theta(values: Sequence[float], dt: float) -> Array:
    """Logarithms of the parameters; of lag + dt for the lag, which may be zero.

    Others may be zero only where they are fixed: then the logarithm is −inf and stays so.
    """
    theta = np.array(values, dtype=float)
    theta[-1] += dt
    with np.errstate(divide="ignore"):
        return np.asarray(np.log(theta))


def from_theta(theta: Array, dt: float) -> Array:
    """Parameters in the order of NAMES."""
    values = np.exp(theta)
    lag = values[-1] - dt
    values[-1] = lag if lag > 1e-9 * dt else 0.0
    return values

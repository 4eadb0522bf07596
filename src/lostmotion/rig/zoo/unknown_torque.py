"""What a recording does not tell of the torques: noise that the speed answers to, and a load torque."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...systems import zero_order_hold
from ..equivalent import chain_matrix
from .drive import Drive, actual_torque

Array = NDArray[np.float64]

#: Change of the filter's gain below which it is settled, relative (numerics).
SETTLED = 1e-9


def torque_noise(drive: Drive) -> float:
    """Standard deviation of what is not known of the motor torque in a row, Nm.

    A command is known. A measured torque has noise, and is not known between its rows: what a straight line leaves of
    the mean is taken as noise, too.
    """
    if drive.dimensions["torque"] == "commanded":
        return 0.0
    motion, logged = drive.motion, drive.recording["torque_motor"]
    acting = actual_torque(motion, drive.truth.drivetrain.actuator.lag)[: logged.size * motion.steps]
    rows = acting[:: motion.steps]
    means = acting.reshape(logged.size, motion.steps).mean(axis=1)
    between = means[:-1] - 0.5 * (rows[:-1] + rows[1:])
    return float(np.hypot(np.std(logged - rows), np.std(between)))


def load_changes(drive: Drive) -> list[Array]:
    """Changes of the load torque that are not known, Nm at the plant's steps: its level, and if it is slow its phase
    and its frequency."""
    if drive.motion.load == "none":
        return []
    load = drive.motion.signals["torque_load"]
    if drive.motion.load == "constant":
        return [load]
    slope = np.gradient(load)
    size = max(float(np.max(np.abs(load))), 1e-300)
    shapes = [load, slope, np.arange(load.size) * slope]
    return [shape * size / max(float(np.max(np.abs(shape))), 1e-300) for shape in shapes]


@dataclass(frozen=True, eq=False)
class Whitening:
    """A Kalman filter after which the noise of sensor and motor torque is white, and of size one.

    It has the chain with its gaps closed and without Coulomb friction.

    Parameters
    ----------
    transition : (2n, 2n) array
        Of angles and speeds over a row of the recording.
    entry : (2n,) array
        Of an error of the torque that is held over the row: one standard deviation.
    shown : (2n,) array
        Row of the sensor.
    noise : float, rad or rad/s
        Of the sensor.
    """

    transition: Array
    entry: Array
    shown: Array
    noise: float

    @classmethod
    def of(cls, drive: Drive) -> Whitening:
        chain, sensor, n = drive.truth.drivetrain, drive.sensor, len(drive.truth.drivetrain.inertias)
        stiffness = chain_matrix([shaft.stiffness for shaft in chain.shafts])
        damping = chain_matrix([shaft.damping for shaft in chain.shafts])
        damping += np.diag([friction.viscous for friction in chain.frictions])
        weights = 1.0 / np.array(chain.inertias)[:, None]
        a = np.block([[np.zeros((n, n)), np.eye(n)], [-weights * stiffness, -weights * damping]])
        b = np.zeros((2 * n, 1))
        b[n] = weights[0]
        transition, entry = zero_order_hold(a, b, drive.motion.dt)
        shown = np.zeros(2 * n)
        shown[0 if sensor.source == "angle_motor" else n] = 1.0
        noise = sensor.noise or sensor.resolution / math.sqrt(12.0)
        return cls(transition, torque_noise(drive) * entry[:, 0], shown, noise)

    def of_columns(self, columns: Array) -> Array:
        """(m, k) columns of what the sensor shows in k rows."""
        if not np.any(self.entry):
            return columns / self.noise
        transition, shown, order = self.transition, self.shown, self.shown.size
        process = np.outer(self.entry, self.entry)
        covariance, state = np.zeros_like(process), np.zeros((order, columns.shape[0]))
        gain, deviation, settled = np.zeros(order), self.noise, False
        found = np.empty_like(columns)
        for k in range(columns.shape[1]):
            if not settled:
                before = gain
                deviation = math.sqrt(float(shown @ covariance @ shown) + self.noise**2)
                gain = covariance @ shown / deviation**2
                left = covariance - np.outer(gain, shown @ covariance)
                covariance = transition @ left @ transition.T + process
                covariance = 0.5 * (covariance + covariance.T)
                settled = k > order and bool(np.max(np.abs(gain - before)) <= SETTLED * np.max(np.abs(gain)))
            innovation = columns[:, k] - shown @ state
            found[:, k] = innovation / deviation
            state = transition @ (state + np.outer(gain, innovation))
        return found

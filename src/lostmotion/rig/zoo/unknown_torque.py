"""What a recording does not tell of the torques: noise that the speed answers to, and a load torque."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
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


def whitened(columns: Array, drive: Drive, noise: float) -> Array:
    """(m, n) columns of what the sensor shows in n rows, over its noise, after a Kalman filter that makes noise of the
    sensor (``noise``) and of the torque white.

    The filter has the chain with its gaps closed and without Coulomb friction.
    """
    torque = torque_noise(drive)
    if not torque > 0.0:
        return columns / noise
    transition, entry, shown = _closed_chain(drive)
    order = transition.shape[0]
    process = np.outer(entry, entry) * torque**2
    covariance, state = np.zeros_like(process), np.zeros((order, columns.shape[0]))
    gain, deviation, settled = np.zeros(order), noise, False
    found = np.empty_like(columns)
    for k in range(columns.shape[1]):
        if not settled:
            before = gain
            deviation = math.sqrt(float(shown @ covariance @ shown) + noise**2)
            gain = covariance @ shown / deviation**2
            covariance = (
                transition @ (covariance - np.outer(gain, shown @ covariance)) @ transition.T + process
            )
            covariance = 0.5 * (covariance + covariance.T)
            settled = k > order and bool(np.max(np.abs(gain - before)) <= SETTLED * np.max(np.abs(gain)))
        innovation = columns[:, k] - shown @ state
        found[:, k] = innovation / deviation
        state = transition @ (state + np.outer(gain, innovation))
    return found


def _closed_chain(drive: Drive) -> tuple[Array, Array, Array]:
    """Transition over a row, entry of a torque that is held over it, and row of the sensor."""
    from scipy.linalg import expm

    a, b = _dynamics(drive.truth.drivetrain)
    order = a.shape[0]
    block = np.zeros((order + 1, order + 1))
    block[:order, :order], block[:order, order] = a, b
    moved = expm(block * drive.motion.dt)
    shown = np.zeros(order)
    shown[0 if drive.sensor.source == "angle_motor" else order // 2] = 1.0
    return moved[:order, :order], moved[:order, order], shown


def _dynamics(chain: Drivetrain) -> tuple[Array, Array]:
    """Angles and speeds of all inertias in continuous time."""
    n = len(chain.inertias)
    stiffness, damping = np.zeros((n, n)), np.diag([friction.viscous for friction in chain.frictions])
    for i, shaft in enumerate(chain.shafts):
        pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
        stiffness[i : i + 2, i : i + 2] += shaft.stiffness * pair
        damping[i : i + 2, i : i + 2] += shaft.damping * pair
    weights = 1.0 / np.array(chain.inertias)
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = np.eye(n)
    a[n:, :n], a[n:, n:] = -weights[:, None] * stiffness, -weights[:, None] * damping
    b = np.zeros(2 * n)
    b[n] = weights[0]
    return a, b

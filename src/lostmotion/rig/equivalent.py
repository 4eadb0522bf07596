"""The two-mass model closest to a finer plant with one backlash: the true values for an identification."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain, Friction
from ..errors import InvalidInput

#: Friction is identifiable only if the magnitudes of the recorded speeds differ by this share of the largest (numerics:
#: rounding of the least squares).
LEAST_SPREAD = 1e-6


@checks_arguments
def eigenfrequencies(drivetrain: Drivetrain) -> NDArray[np.float64]:
    """Undamped eigenfrequencies with all gaps closed, Hz, rising, the first is 0 (rigid rotation)."""
    return _frequencies(drivetrain, locked_motor=False)


@checks_arguments
def motor_zeros(drivetrain: Drivetrain) -> NDArray[np.float64]:
    """Zeros of motor angle / motor torque with all gaps closed, Hz: the eigenfrequencies with the motor locked."""
    return _frequencies(drivetrain, locked_motor=True)


def chain_matrix(values: Sequence[float]) -> NDArray[np.float64]:
    """(n, n) stiffness or damping matrix of a chain of n inertias, from the values of its n − 1 shafts."""
    matrix = np.zeros((len(values) + 1,) * 2)
    for i, value in enumerate(values):
        matrix[i : i + 2, i : i + 2] += value * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return matrix


def _frequencies(drivetrain: Drivetrain, locked_motor: bool) -> NDArray[np.float64]:
    stiffness = chain_matrix([shaft.stiffness for shaft in drivetrain.shafts])
    scale = 1.0 / np.sqrt(np.array(drivetrain.inertias))
    scaled = scale[:, None] * stiffness * scale
    if locked_motor:
        scaled = scaled[1:, 1:]
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(scaled), 0.0)) / (2.0 * math.pi))


@checks_arguments
def two_mass_equivalent(drivetrain: Drivetrain, speed_load: NDArray[np.float64]) -> dict[str, float | None]:
    """Parameters of the equivalent two-mass drivetrain, by name, SI.

    Inertias: the sums on each side of the gap, or of the softest shaft where there is no gap. Stiffness: from
    the first pole with the gap closed and those inertias. Damping: from the series of the shafts. Coulomb and
    viscous: least-squares line through the true friction curve at the recorded load speeds (n,), rad/s, as far as
    they are finite; None for both where the load never moves, or at one speed only.
    """
    if sum(shaft.has_backlash for shaft in drivetrain.shafts) > 1:
        raise InvalidInput("two_mass_equivalent", "several backlashes", "at most one", "Close the others.")
    joint = joint_of(drivetrain)
    motor = math.fsum(drivetrain.inertias[: joint + 1])
    load = math.fsum(drivetrain.inertias[joint + 1 :])
    pole = 2.0 * math.pi * float(eigenfrequencies(drivetrain)[1])
    stiffness = pole**2 / (1.0 / motor + 1.0 / load)
    # In series the compliances add, and in slow motion each shaft dissipates d·(share of the twist)².
    compliance = math.fsum(1.0 / shaft.stiffness for shaft in drivetrain.shafts)
    speed_load = np.atleast_1d(np.asarray(speed_load, dtype=float))
    damping = math.fsum(s.damping * (1.0 / s.stiffness / compliance) ** 2 for s in drivetrain.shafts)
    coulomb, viscous = friction_line(drivetrain.frictions[-1], speed_load)
    return {
        "inertia_motor": motor,
        "inertia_load": load,
        "stiffness": stiffness,
        "damping": damping,
        "backlash": drivetrain.shafts[joint].backlash,
        "coulomb": coulomb,
        "viscous": viscous,
        "lag": drivetrain.actuator.lag,
    }


def joint_of(drivetrain: Drivetrain) -> int:
    """The shaft between motor side and load side: that with the largest gap, else the softest; 0 if there is none."""
    order = [(-shaft.backlash, shaft.stiffness) for shaft in drivetrain.shafts]
    return order.index(min(order)) if order else 0


def friction_line(friction: Friction, speed: NDArray[np.float64]) -> tuple[float | None, float | None]:
    """Coulomb (Nm) and viscous friction (Nm s/rad) of the line closest to the friction curve at these speeds."""
    moving = speed[np.isfinite(speed) & (speed != 0.0)]
    size = np.abs(moving)
    if moving.size == 0 or np.ptp(size) <= LEAST_SPREAD * np.max(size):
        return None, None
    if moving.size > 5000:
        moving = moving[:: moving.size // 5000]
    # In units of the largest speed: those of an unstable loop are too large to be squared.
    largest = float(np.max(size))
    torque = np.array([friction.torque(float(w)) for w in moving])
    columns = np.column_stack([np.sign(moving), moving / largest])
    coulomb, viscous = np.linalg.lstsq(columns, torque, rcond=None)[0]
    return float(coulomb), float(viscous) / largest

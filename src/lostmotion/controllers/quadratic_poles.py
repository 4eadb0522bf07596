"""Poles for the state feedback of a drivetrain, from one number: the torque that a speed error deserves."""

from __future__ import annotations

import math

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput

#: Weight of the motor's oscillation against the load: motor − load speed may be this many times the error of the load
#: speed (calibrated on the virtual rigs 1 to 5, as in ``lqi``).
OSCILLATION_SHARE = 2.0


@checks_arguments
def quadratic_poles(drivetrain: Drivetrain, torque_per_error: float) -> tuple[complex, complex, complex]:
    """Closed-loop poles of the linear-quadratic optimum, in 1/s, for ``pole_placement``.

    ::

        minimise  ∫ (torque_per_error·speed_load)² + (torque_per_error·(speed_motor − speed_load)/2)² + torque² dt

    A little torque only damps the torsional mode and leaves its frequency; more torque makes all three fast. Poles that
    are chosen by hand easily ask the controller to hold the mode back, which costs much torque and all of the margin.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses, the gap closed; its actuator lag is neglected.
    torque_per_error : float, Nm s/rad
        Torque that a speed error of 1 rad/s deserves: the bandwidth follows from it.

    Raises
    ------
    InvalidInput
        If it is not a positive number.

    Notes
    -----
    Bryson & Ho 1975, Applied Optimal Control, section 5.2.
    """
    from scipy.linalg import solve_continuous_are

    if not (math.isfinite(torque_per_error) and torque_per_error > 0.0):
        raise InvalidInput(
            "quadratic_poles.torque_per_error",
            repr(torque_per_error),
            "a positive number in Nm s/rad",
            "Check it.",
        )
    a, b = drivetrain.linear()
    # Time in units of the mode, torque in units that accelerate in it: the equation is solved the same for all sizes.
    rate = 2.0 * math.pi * drivetrain.pole_frequency
    scale = np.array([1.0 / rate, 1.0, 1.0])
    torque = drivetrain.inertia_total * rate
    a = a / rate * scale / scale[:, None]
    b = b / rate / scale[:, None] * torque
    outputs = np.array([[0.0, 0.0, 1.0], [0.0, 1.0 / OSCILLATION_SHARE, -1.0 / OSCILLATION_SHARE]])
    weight = outputs.T @ outputs * (torque_per_error / torque) ** 2
    p = solve_continuous_are(a, b, weight, np.eye(1))
    first, second, third = (complex(pole) for pole in rate * np.linalg.eigvals(a - b @ b.T @ p))
    return first, second, third

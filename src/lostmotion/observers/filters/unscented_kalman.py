"""Unscented Kalman filter that knows its backlash: the states of ``extended_kalman``, moved as points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

from ...drivetrain import Drivetrain
from ...systems import Stepper
from .tracking_parameters import TRACKING_OUTPUTS, tracking_parameters
from .tuning import TRACKING_TORQUE, Tuning, measured_sensors
from .two_mass_parameters import stepper


def unscented_kalman(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    **tuning: Unpack[Tuning],
) -> Stepper:
    """Unscented Kalman filter of a two-mass drivetrain: tuning, states and outputs of ``extended_kalman``.

    Its prediction moves 23 points (two fewer for each state without variance) through the model with the true, sharp
    gap and friction instead of linearising; linear sensors correct it as in the Kalman filter, the shaft torque by
    statistical linearisation.

    Parameters
    ----------
    drivetrain, measured, dt, tuning
        As in ``extended_kalman``.

    Returns
    -------
    Stepper
        Inputs torque_motor and ``measured``; outputs ``TRACKING_OUTPUTS``.

    Raises
    ------
    InvalidInput
        As ``extended_kalman``.

    Notes
    -----
    Julier & Uhlmann 2004, Proc. IEEE 92, 401–422, with κ = 1.
    """
    measured = measured_sensors(measured)
    parameters = tracking_parameters(drivetrain, measured, dt, TRACKING_TORQUE, tuning)
    return stepper("unscented_kalman", TRACKING_OUTPUTS, measured, dt, parameters)

"""Unscented Kalman filter that knows its backlash: the states of ``extended_kalman``, moved as points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ..drivetrain import Drivetrain
from ..systems import Stepper
from .extended_kalman import extended_kalman

#: As ``tuning.UNKNOWN_TORQUE``, Nm·√s. Chosen: with 0.02 on the motor it grew too sure of itself while the load sticks
#: and locked onto a wrong Coulomb level on two virtual rigs of sixteen; with 0.05 on none of twenty.
UNKNOWN_TORQUE: Mapping[str, float] = {"motor": 0.05, "load": 0.02}


def unscented_kalman(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    sensor_noise: Mapping[str, float] | None = None,
    unknown_torque: Mapping[str, float] | None = None,
    drift: Mapping[str, float] | None = None,
    uncertainty: Mapping[str, float] | None = None,
    count_averaged: bool = False,
) -> Stepper:
    """Unscented Kalman filter of a two-mass drivetrain: tuning, states and outputs of ``extended_kalman``.

    Its default ``unknown_torque`` on the motor is larger, see ``UNKNOWN_TORQUE``.

    Its prediction moves 17 points through the model with the true, sharp gap and friction instead of linearising;
    linear sensors correct it as in the Kalman filter, the shaft torque by statistical linearisation.

    Notes
    -----
    Julier & Uhlmann 2004, Proc. IEEE 92, 401–422, with κ = 1.
    """
    extended = extended_kalman(
        drivetrain, measured=measured, dt=dt, sensor_noise=sensor_noise,
        unknown_torque={**UNKNOWN_TORQUE, **(unknown_torque or {})}, drift=drift, uncertainty=uncertainty,
        count_averaged=count_averaged,
    )  # fmt: skip
    kernel = "lostmotion.kernels.steppers_unscented_kalman"
    return replace(extended, name="unscented_kalman", kernel=kernel)

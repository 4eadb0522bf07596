"""Interacting multiple models: contact +, gap and contact −, each a Kalman filter, with their probabilities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..drivetrain import Drivetrain
from ..systems import Stepper
from .extended_kalman import fill_tracking
from .tuning import measured_sensors, model_parameters

OUTPUTS = (
    "twist_estimated",
    "twist_elastic_estimated",
    "speed_motor_estimated",
    "speed_load_estimated",
    "torque_shaft_estimated",
    "friction_load_estimated",
    "torque_load_estimated",
    "probability_contact_positive",
    "probability_gap",
    "probability_contact_negative",
    "twist_deviation",
    "speed_motor_deviation",
    "speed_load_deviation",
    "torque_shaft_deviation",
    "torque_load_deviation",
)

#: Smallest chance of a change to any model in a sample (chosen): what brings a model back that seemed impossible.
LEAST_CHANGE = 1e-6


def interacting_models(
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
    """Three Kalman filters — contact +, gap, contact − — that interact by their probabilities.

    Every model is linear in its region; the chance to change from one to another follows from where the first one
    places the twist, and the likelihood of the measurement weighs them. Estimates are the means of the mixture; the
    elastic twist is that of the mean twist.

    Parameters
    ----------
    drivetrain, measured, dt, sensor_noise, unknown_torque, count_averaged
        As in ``extended_kalman``.
    drift, uncertainty : mapping, optional
        Of ``torque_load`` (Nm) alone; default ``extended_kalman.DRIFT``, ``UNCERTAINTY``.

    Returns
    -------
    Stepper
        Inputs torque_motor and ``measured``; outputs ``OUTPUTS``: estimates, ``probability_…`` of the three models
        (they sum to 1), standard deviations.

    Raises
    ------
    InvalidInput
        For unknown names and for numbers out of range.

    Notes
    -----
    Blom & Bar-Shalom 1988, IEEE Trans. Automatic Control 33, 780–783, with transitions that depend on the state; for
    backlash as a hybrid system: Ferrari-Trecate & Gati 2006, Int. J. Control 79, 496–507.
    """
    from ..kernels import steppers_interacting_models as kernel
    from ..kernels import steppers_model as at

    measured = measured_sensors(measured)
    p = np.zeros(kernel.LEAST + 1)
    p[: at.OWN] = model_parameters(drivetrain, measured, dt, sensor_noise, count_averaged)
    fill_tracking(p, drivetrain, unknown_torque, drift, uncertainty)
    p[at.START_VARIANCE] = (0.25 * drivetrain.backlash) ** 2 + 1e-8
    p[kernel.HALF], p[kernel.COULOMB] = 0.5 * drivetrain.backlash, drivetrain.coulomb
    p[kernel.LEAST] = LEAST_CHANGE
    return Stepper(
        name="interacting_models",
        inputs=("torque_motor", *measured),
        outputs=OUTPUTS,
        dt=dt,
        parameters=p,
        kernel="lostmotion.kernels.steppers_interacting_models",
    )

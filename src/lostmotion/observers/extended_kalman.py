"""Extended Kalman filter that knows its backlash: backlash, Coulomb level and load torque are states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from ..drivetrain import Drivetrain
from ..systems import Stepper
from .tuning import Array, chosen, measured_sensors, model_parameters, process_of_torque

#: Outputs of the filters that track parameters.
TRACKING_OUTPUTS = (
    "twist_estimated",
    "twist_elastic_estimated",
    "speed_motor_estimated",
    "speed_load_estimated",
    "torque_shaft_estimated",
    "friction_load_estimated",
    "torque_load_estimated",
    "backlash_estimated",
    "coulomb_estimated",
    "twist_deviation",
    "speed_motor_deviation",
    "speed_load_deviation",
    "torque_shaft_deviation",
    "torque_load_deviation",
    "backlash_deviation",
    "coulomb_deviation",
)

#: How far each parameter wanders within a second (standard deviation): backlash and coulomb as a fraction of their
#: start value, torque_load in Nm (chosen; 0.02 follows a wear of 1 % per second).
DRIFT: Mapping[str, float] = MappingProxyType({"backlash": 0.02, "coulomb": 0.02, "torque_load": 0.5})

#: How well each is known at the start (standard deviation), in the same units (chosen).
UNCERTAINTY: Mapping[str, float] = MappingProxyType({"backlash": 0.3, "coulomb": 0.15, "torque_load": 0.1})

#: The Coulomb level stays within this many start deviations above its start value (chosen). An estimate that is far too
#: high would hold the load for ever and never learn otherwise.
COULOMB_REACH = 4.0


def extended_kalman(
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
    """Extended Kalman filter of a two-mass drivetrain with backlash, Coulomb level and load torque as states.

    The model is that of ``kalman``. The dead zone enters by its mean over the estimate's own spread, so the filter
    knows that contact is uncertain near the edge of the gap.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; its backlash and Coulomb level are the start values.
    measured : sequence of str
        Any of speed_motor, speed_load, twist, torque_shaft (SI units).
    dt : float, s
        Sample time.
    sensor_noise : mapping of signal → float, optional
        Standard deviation of one sample, in the signal's unit; default ``tuning.SENSOR_NOISE``, with ``count_averaged``
        that of a 20-bit encoder at this sample time (``tuning.speed_of_counts(dt, counts)`` gives it for another one).
    unknown_torque : mapping, optional
        Torque on ``motor`` and ``load`` that the model leaves out, as the root of its density, Nm·√s; default
        ``tuning.UNKNOWN_TORQUE``.
    drift, uncertainty : mapping, optional
        Of ``backlash`` and ``coulomb`` (fractions of the start value) and ``torque_load`` (Nm): how far it wanders
        within a second, and how well it is known at the start; default ``DRIFT``, ``UNCERTAINTY``. Zero for both
        holds a parameter.
    count_averaged : bool
        The measured motor speed is a difference of counts over dt: the sum of its samples, an angle, is filtered, in
        which a count has one error instead of two.

    Returns
    -------
    Stepper
        Inputs torque_motor and ``measured``; outputs ``TRACKING_OUTPUTS``. The estimates of a sample use the
        measurement of that sample.

    Raises
    ------
    InvalidInput
        For unknown names and for numbers out of range.

    Notes
    -----
    After Lagerberg & Egardt 2007, IEEE Trans. Control Systems Technology 15, 483–493; dead zone by statistical
    linearisation (Gelb 1974, Applied Optimal Estimation, chapter 6).
    """
    measured = measured_sensors(measured)
    p = model_parameters(drivetrain, measured, dt, sensor_noise, count_averaged)
    fill_tracking(p, drivetrain, unknown_torque, drift, uncertainty)
    return Stepper(
        name="extended_kalman",
        inputs=("torque_motor", *measured),
        outputs=TRACKING_OUTPUTS,
        dt=dt,
        parameters=p,
        kernel="lostmotion.kernels.steppers_extended_kalman",
    )


def fill_tracking(
    p: Array,
    drivetrain: Drivetrain,
    unknown_torque: Mapping[str, float] | None,
    drift: Mapping[str, float] | None,
    uncertainty: Mapping[str, float] | None,
) -> None:
    """Start values, their variances and the process variances of the eight states, written into ``p``."""
    from ..kernels import steppers_model as at

    wander = chosen("drift", DRIFT, drift, zero=True)
    known = chosen("uncertainty", UNCERTAINTY, uncertainty, zero=True)
    backlash, coulomb = drivetrain.backlash, drivetrain.coulomb
    units = np.array([1.0, backlash, coulomb])
    names = ("torque_load", "backlash", "coulomb")
    dt = p[at.DT] / p[at.PIECES]
    q_motor, q_load = process_of_torque(drivetrain, unknown_torque, dt)
    p[at.START + 5 : at.START + 8] = 0.0, backlash, coulomb
    # At the start the twist lies anywhere in the gap, the load turns about as fast as the motor.
    p[at.START_VARIANCE : at.START_VARIANCE + 4] = (0.5 * backlash) ** 2 + 1e-8, 0.25, 0.25, 0.25
    if p[at.AVERAGED]:
        motor = list(p[at.KIND : at.KIND + int(p[at.N_SENSORS])]).index(0.0)
        p[at.START_VARIANCE + at.ANGLE] = p[at.VARIANCE + motor]
    p[at.COULOMB_BOUND] = (1.0 + COULOMB_REACH * known["coulomb"]) * coulomb
    p[at.START_VARIANCE + 5 : at.START_VARIANCE + 8] = (units * [known[n] for n in names]) ** 2
    p[at.PROCESS : at.PROCESS + 5] = 1e-14, q_motor, q_load, 0.0, 0.0
    p[at.PROCESS + 5 : at.PROCESS + 8] = (units * [wander[n] for n in names]) ** 2 * dt

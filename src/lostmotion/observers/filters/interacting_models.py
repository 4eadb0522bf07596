"""Interacting multiple models: contact +, gap and contact −, each a Kalman filter, with their probabilities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Unpack

import numpy as np

from ...drivetrain import Drivetrain
from ...systems import Stepper
from ..scale import scale_of
from .extended_kalman import START_TWIST, tracking_parameters
from .tuning import Tuning, measured_sensors

OUTPUTS = (
    "twist_estimated",
    "twist_elastic_estimated",
    "speed_motor_estimated",
    "speed_load_estimated",
    "torque_shaft_estimated",
    "friction_load_estimated",
    "torque_load_estimated",
    "coulomb_estimated",
    "probability_contact_positive",
    "probability_gap",
    "probability_contact_negative",
    "twist_deviation",
    "speed_motor_deviation",
    "speed_load_deviation",
    "torque_shaft_deviation",
    "torque_load_deviation",
    "coulomb_deviation",
)

#: As ``tuning.PROCESS_TORQUE``, Nm·√s, and ``extended_kalman.DRIFT``, Nm in 1 s (chosen on virtual rigs with even
#: seeds: with a twist that wanders, the motor's inertia 20 % off and an unknown load torque need these).
PROCESS_TORQUE: Mapping[str, float] = MappingProxyType({"motor": 0.03, "load": 0.01})
DRIFT: Mapping[str, float] = MappingProxyType({"torque_load": 0.7})

#: How far the twist wanders beside the model in contact and in the gap, rad/√s (chosen): the gap lies beyond a piece of
#: the joint that swings. An exact twist is held on to where it is wrong.
CONTACT_WANDER, GAP_WANDER = 5e-4, 2e-3

#: Chance in a second that a model begins anew (chosen): what finds the twist again where it was lost.
ANEW = 1e-5

#: How long the errors of prediction are alike, s (chosen: the joint's own mode, 750 Hz, which no model has, swings for
#: milliseconds; with 1 ms a fault of the sensor was forgotten too late). Samples closer than this are no independent
#: evidence: the likelihood counts by its share of this time.
ALIKE = 5e-4


def interacting_models(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    **tuning: Unpack[Tuning],
) -> Stepper:
    """Three Kalman filters — contact +, gap, contact − — that interact by their probabilities.

    A model is linear in its region but for the friction. What goes over from one to another is the part of its
    distribution in which the twist lies in the other's region; the likelihood of the measurement weighs them.
    Estimates are the means of the mixture; the elastic twist is that of the mean twist.

    Parameters
    ----------
    drivetrain, measured, dt, **tuning
        As in ``extended_kalman``, with other defaults: ``PROCESS_TORQUE``, ``DRIFT``. Of ``drift`` and ``uncertainty``
        only ``torque_load`` and ``coulomb`` count; the rest is fixed.

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
    Blom & Bar-Shalom 1988, IEEE Trans. Automatic Control 33, 780–783, with transitions that depend on the state: the
    parts of a normal distribution by their truncated moments (Johnson, Kotz & Balakrishnan 1994, Continuous Univariate
    Distributions 1, section 13.10.1). For backlash as a hybrid system: Ferrari-Trecate & Gati 2006, Int. J. Control
    79, 496–507.
    """
    from ...kernels.estimators import two_mass_model as at
    from ...kernels.estimators.interacting_models import state as kernel

    measured = measured_sensors(measured)
    p = np.zeros(kernel.GAP_PROCESS + 1)
    p[: at.OWN] = tracking_parameters(drivetrain, measured, dt, PROCESS_TORQUE, tuning, DRIFT)
    angle = scale_of(drivetrain).angle
    p[at.START_VARIANCE] = (0.25 * drivetrain.backlash) ** 2 + (START_TWIST * angle) ** 2
    for place in (at.START, at.START_VARIANCE, at.PROCESS):
        p[place + kernel.COULOMB] = p[place + 7]  # the backlash is no state here
    piece = dt / p[at.PIECES]
    p[at.PROCESS] = (CONTACT_WANDER * angle) ** 2 * piece
    p[kernel.GAP_PROCESS] = (GAP_WANDER * angle) ** 2 * piece
    p[kernel.HALF], p[kernel.ANEW] = 0.5 * drivetrain.backlash, ANEW * piece
    p[kernel.SHARE] = min(1.0, dt / ALIKE)
    return Stepper(
        name="interacting_models",
        inputs=("torque_motor", *measured),
        outputs=OUTPUTS,
        dt=dt,
        parameters=p,
        estimator="interacting_models",
    )

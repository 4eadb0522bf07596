"""Interacting multiple models: contact +, gap and contact −, each a Kalman filter, with their probabilities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Unpack

import numpy as np

from ...drivetrain import Drivetrain
from ...kernels.estimators.layout import COULOMB, INTERACTING_PARAMETERS, MODEL_COULOMB, TWIST
from ...systems import Stepper
from ..estimates import ESTIMATES, deviations, estimated
from ..scale import scale_of
from .tracking_parameters import START_TWIST, tracking_parameters
from .tuning import Tuning, measured_sensors
from .two_mass_parameters import stepper

OUTPUTS = (
    *ESTIMATES,
    *estimated("torque_load", "coulomb"),
    "probability_contact_positive",
    "probability_gap",
    "probability_contact_negative",
    *deviations("twist", "speed_motor", "speed_load", "torque_shaft", "torque_load", "coulomb"),
)

#: As ``tuning.TRACKING_TORQUE``, Nm·√s, and ``tuning.DRIFT``, Nm in 1 s. Calibration: virtual rigs with even seeds;
#: with a twist that drifts, the motor's inertia 20 % off and an unknown load torque need these.
MODELS_TORQUE: Mapping[str, float] = MappingProxyType({"motor": 0.03, "load": 0.01})
#: Calibration: the same.
MODELS_DRIFT: Mapping[str, float] = MappingProxyType({"torque_load": 0.7})

#: How far the twist drifts beside the model in contact and in the gap, rad/√s. The gap lies beyond an inertia of the
#: joint that swings, and an exact twist would never be corrected. Calibration: virtual rigs with even seeds.
CONTACT_DRIFT, GAP_DRIFT = 5e-4, 2e-3

#: Chance in a second that a model begins anew: what finds the twist again where it was lost. Calibration: virtual rigs
#: with even seeds.
ANEW = 1e-5

#: How long the errors of prediction are alike, s. Samples closer than this are no independent evidence: the likelihood
#: counts by its share of this time. Calibration: virtual rigs with even seeds, whose joint has an eigenmode of 750 Hz
#: that swings for milliseconds; with 1 ms a fault of the sensor was forgotten too late.
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
        As in ``extended_kalman``, with other defaults: ``MODELS_TORQUE``, ``MODELS_DRIFT``. Of ``drift`` and
        ``uncertainty`` only ``torque_load`` and ``coulomb`` count; the rest is fixed.

    Returns
    -------
    Stepper
        Inputs torque_motor and ``measured``; outputs ``OUTPUTS``: estimates, ``probability_…`` of the three models
        (they sum to 1), standard deviations.

    Raises
    ------
    InvalidInput
        For unknown sensors or names of the tuning, and for numbers out of range.

    Notes
    -----
    Blom & Bar-Shalom 1988, IEEE Trans. Automatic Control 33, 780–783, with transitions that depend on the state: the
    parts of a normal distribution by their truncated moments (Johnson, Kotz & Balakrishnan 1994, Continuous Univariate
    Distributions 1, section 13.10.1). For backlash as a hybrid system: Ferrari-Trecate & Gati 2006, Int. J. Control
    79, 496–507.
    """
    measured = measured_sensors(measured)
    parameters = np.zeros((), INTERACTING_PARAMETERS)
    p = parameters["common"]
    p[()] = tracking_parameters(drivetrain, measured, dt, MODELS_TORQUE, tuning, MODELS_DRIFT)
    angle, substep = scale_of(drivetrain).angle, dt / p["substeps"]
    p["P0"][TWIST] = (0.25 * drivetrain.backlash) ** 2 + (START_TWIST * angle) ** 2
    p["Q"][TWIST] = (CONTACT_DRIFT * angle) ** 2 * substep
    parameters["gap_Q"] = (GAP_DRIFT * angle) ** 2 * substep
    for of_states in (p["x0"], p["P0"], p["Q"]):
        of_states[MODEL_COULOMB] = of_states[COULOMB]  # the backlash is no state here
    parameters["half_gap"], parameters["anew"] = 0.5 * drivetrain.backlash, ANEW * substep
    parameters["likelihood_share"] = min(1.0, dt / ALIKE)
    return stepper("interacting_models", OUTPUTS, measured, dt, parameters)

"""Extended Kalman filter that knows its backlash: what may be wrong or change is a state."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Unpack

import numpy as np

from ...drivetrain import Drivetrain
from ...systems import Stepper
from ..scale import scale_of
from .tuning import (
    MODE_SHARE,
    Array,
    Tuning,
    checked_names,
    chosen,
    measured_sensors,
    mode_numbers,
    model_parameters,
    process_of_torque,
)

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
    "stiffness_estimated",
    "inertia_motor_estimated",
    "inertia_load_estimated",
    "twist_deviation",
    "speed_motor_deviation",
    "speed_load_deviation",
    "torque_shaft_deviation",
    "torque_load_deviation",
    "backlash_deviation",
    "coulomb_deviation",
    "stiffness_deviation",
    "inertia_motor_deviation",
    "inertia_load_deviation",
)

#: How far each parameter wanders within a second (standard deviation): ``torque_load`` in Nm, the others as fractions
#: of what was told (chosen; 0.015 follows a wear of 1 % per second, 0.003 a shaft that grows warm).
DRIFT: Mapping[str, float] = MappingProxyType(
    {
        "backlash": 0.015,
        "coulomb": 0.02,
        "torque_load": 0.5,
        "stiffness": 0.003,
        "inertia_motor": 0.003,
        "inertia_load": 0.003,
    }
)

#: How well each is known at the start (standard deviation), in the same units. Chosen; stiffness and inertias as an
#: identification gives them: what is 20 % off is found as well, only some tenths of a second later.
UNCERTAINTY: Mapping[str, float] = MappingProxyType(
    {
        "backlash": 0.3,
        "coulomb": 0.15,
        "torque_load": 0.1,
        "stiffness": 0.01,
        "inertia_motor": 0.01,
        "inertia_load": 0.01,
    }
)

#: Torque that the model leaves out, as the root of its density, Nm·√s. Chosen on virtual rigs 1 to 4: with less on the
#: motor a filter grows too sure of itself, with more it follows an unknown load torque worse and finds the gap worse
#: under control.
PROCESS_TORQUE: Mapping[str, float] = MappingProxyType({"motor": 0.05, "load": 0.02})

#: Standard deviations at the start: of the twist beside the gap, rad, and of both speeds, rad/s; and what the twist
#: wanders in a piece of a sample, rad, so that no variance vanishes (all chosen).
START_TWIST, START_SPEED, SMALLEST_WANDER = 1e-4, 0.5, 1e-7

#: The Coulomb level stays within this many start deviations above its start value (chosen). An estimate that is far too
#: high would hold the load for ever and never learn otherwise.
COULOMB_REACH = 4.0


def extended_kalman(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    **tuning: Unpack[Tuning],
) -> Stepper:
    """Extended Kalman filter of a two-mass drivetrain that tracks backlash, friction, load torque, stiffness, inertia.

    The model is that of ``kalman``. The dead zone enters by its mean over the estimate's own spread, so the filter
    knows that contact is uncertain near the edge of the gap. ``stiffness`` stands for the whole shaft: its damping is
    multiplied by the same factor.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; its backlash, Coulomb level, stiffness and inertias are the start values.
    measured : sequence of str
        Any of speed_motor, speed_load, twist, torque_shaft (SI units).
    dt : float, s
        Sample time.
    **tuning
        See ``tuning.Tuning``; defaults ``PROCESS_TORQUE``, ``DRIFT``, ``UNCERTAINTY``. Stiffness and inertias are
        held between half and twice of what the drivetrain says.

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
    return Stepper(
        name="extended_kalman",
        inputs=("torque_motor", *measured),
        outputs=TRACKING_OUTPUTS,
        dt=dt,
        parameters=tracking_parameters(drivetrain, measured, dt, PROCESS_TORQUE, tuning),
        estimator="extended_kalman",
    )


def tracking_parameters(
    drivetrain: Drivetrain,
    measured: tuple[str, ...],
    dt: float,
    process_torque: Mapping[str, float],
    tuning: Tuning,
    wandering: Mapping[str, float] = DRIFT,
) -> Array:
    """The parameter array of a filter with wandering parameters.

    ``process_torque`` and ``wandering``, the drift, are its defaults for a drivetrain of the paper's size.
    """
    from ...kernels.estimators import two_mass_model as at

    tuning = checked_names(tuning)
    p = model_parameters(
        drivetrain, measured, dt, tuning.get("sensor_noise"), tuning.get("speed_from_counts", False)
    )
    p[at.MODE_SHARE], p[at.MODE_RATE] = mode_numbers("mode_share", tuning.get("mode_share", MODE_SHARE), dt)
    size = scale_of(drivetrain).torque
    default = {name: value * size for name, value in process_torque.items()}
    torque = chosen("process_torque", default, tuning.get("process_torque"), zero=True)
    wander, known = (
        chosen(where, {**usual, "torque_load": usual["torque_load"] * size}, given, zero=True)
        for where, usual, given in (
            ("drift", {**DRIFT, **wandering}, tuning.get("drift")),
            ("uncertainty", UNCERTAINTY, tuning.get("uncertainty")),
        )
    )
    _fill_variances(p, drivetrain, torque, wander, known)
    return p


def _fill_variances(
    p: Array,
    drivetrain: Drivetrain,
    torque: Mapping[str, float],
    wander: Mapping[str, float],
    known: Mapping[str, float],
) -> None:
    """Start values, their variances and the process variances of all states, written into ``p``."""
    from ...kernels.estimators import two_mass_model as at

    backlash, coulomb = drivetrain.backlash, drivetrain.coulomb
    units = np.array([1.0, backlash, coulomb, 1.0, 1.0, 1.0])
    names = ("torque_load", "backlash", "coulomb", "stiffness", "inertia_motor", "inertia_load")
    dt = p[at.DT] / p[at.PIECES]
    q_motor, q_load = process_of_torque(drivetrain, torque, dt)
    p[at.START + 5 : at.START + 11] = 0.0, backlash, coulomb, 1.0, 1.0, 1.0
    # At the start the twist lies anywhere in the gap, the load turns about as fast as the motor; the actuator follows
    # its set-point, and without variance it costs the unscented filter no points.
    scale = scale_of(drivetrain)
    speed = (START_SPEED * scale.speed) ** 2
    twist = (0.5 * backlash) ** 2 + (START_TWIST * scale.angle) ** 2
    p[at.START_VARIANCE : at.START_VARIANCE + 4] = twist, speed, speed, 0.0
    if p[at.AVERAGED]:
        motor = list(p[at.KIND : at.KIND + int(p[at.N_SENSORS])]).index(0.0)
        p[at.START_VARIANCE + at.ANGLE] = p[at.VARIANCE + motor]
    p[at.COULOMB_BOUND] = (1.0 + COULOMB_REACH * known["coulomb"]) * coulomb
    p[at.START_VARIANCE + 5 : at.START_VARIANCE + 11] = (units * [known[n] for n in names]) ** 2
    p[at.PROCESS : at.PROCESS + 5] = (SMALLEST_WANDER * scale.angle) ** 2, q_motor, q_load, 0.0, 0.0
    p[at.PROCESS + 5 : at.PROCESS + 11] = (units * [wander[n] for n in names]) ** 2 * dt

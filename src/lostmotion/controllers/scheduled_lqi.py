"""Linear-quadratic speed control whose gains follow the load inertia that an observer tracks."""

from __future__ import annotations

import math

import numpy as np

from ..argument_checks import Limit, checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import Stepper
from .feedback.feedback_law import actuator_gain, signal_gains
from .feedback.reference_direction import REFERENCE_BAND
from .lqi import quadratic_feedback

#: Smallest and largest load inertia with gains of its own, in multiples of the known one (numerics: beyond what
#: ``extended_kalman`` tracks).
LEAST, MOST = 0.25, 4.0
#: Fastest change of the inertia that the gains are for, 1/s, as a share of it (option: an estimate that jumps or swings
#: with the speed does not swing the gains; a load that is three times as heavy is followed in 0.06 s).
SCHEDULE_RATE = 20.0


@checks_arguments
def scheduled_lqi(
    drivetrain: Drivetrain,
    *,
    dt: float,
    largest_error: float,
    largest_torque: float,
    torque_limit: float,
    largest_oscillation: Limit | None = None,
    largest_twist: float = math.inf,
    schedule_rate: float = SCHEDULE_RATE,
) -> Stepper:
    """The law of ``lqi`` for the load inertia that an observer finds: gains by a table over it, linear between.

    At a constant inertia it is ``lqi``; a steady state is held at any, for what holds it is linear in the gain. The
    inertia that the gains are for changes slowly against the loop, so its stability is that of the laws of the table.
    What is tracked besides is the observer's choice: hold the parameters with which the loop could limit-cycle.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; the gains are for ``LEAST`` to ``MOST`` of its load inertia.
    dt, largest_error, largest_torque, largest_oscillation, largest_twist : as in ``lqi``
    torque_limit : float, Nm
        Finite.
    schedule_rate : float, 1/s
        Fastest change of the inertia that the gains are for, as a share of it; at most 1/dt.

    Returns
    -------
    Stepper
        Inputs of ``lqi`` with ``load_torque``, and inertia_load_estimated (kg m²), as ``extended_kalman`` gives it;
        output torque_motor.

    Raises
    ------
    InvalidInput
        As ``lqi``; also for an infinite torque limit, and a rate that is not between zero and 1/dt.

    Notes
    -----
    Rugh & Shamma 2000, Automatica 36, 1401–1425 (gain scheduling, slowly varying parameters).
    """
    from ..kernels.scheduled_feedback import POINTS  # numba: not for all that imports controllers

    if not (math.isfinite(torque_limit) and torque_limit > 0.0):
        raise InvalidInput(
            "scheduled_lqi.torque_limit", repr(torque_limit), "a positive number in Nm", "Give it."
        )
    if not 0.0 < schedule_rate * dt <= 1.0:
        raise InvalidInput(
            "scheduled_lqi.schedule_rate", repr(schedule_rate), "above 0, at most 1/dt", "20 1/s is usual."
        )
    table: list[list[float]] = []
    inputs: tuple[str, ...] = ()
    for inertia in drivetrain.inertia_load * np.geomspace(LEAST, MOST, POINTS):
        loaded = drivetrain.with_parameters(inertia_load=float(inertia))
        design = quadratic_feedback(
            loaded, dt, largest_error=largest_error, largest_torque=largest_torque,
            largest_oscillation=largest_oscillation, largest_twist=largest_twist,
        )  # fmt: skip
        gains = signal_gains(loaded, design, load_torque=True)
        table.append([inertia, *gains.values(), actuator_gain(design), design.motor_gain])
        inputs = tuple(gains)
    motor = drivetrain.frictions[0]
    law = [
        torque_limit, math.exp(-dt / drivetrain.lag) if drivetrain.lag > 0.0 else 0.0, schedule_rate * dt,
        drivetrain.inertia_load, motor.coulomb_plus, motor.coulomb_minus, REFERENCE_BAND,
    ]  # fmt: skip
    return Stepper(
        name="scheduled_lqi", dt=dt, estimator="scheduled_feedback", exportable=True,
        inputs=(*inputs, "inertia_load_estimated"), outputs=("torque_motor",),
        parameters=np.concatenate([law, np.ravel(table)]),
    )  # fmt: skip

"""State feedback of the design model with what holds a steady state: the form that LQI and H∞ share."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DesignModel, DiscreteSystem
from .limited_torque import actuator_state, limited_torque

Array = NDArray[np.float64]

#: Largest motor oscillation by default, in multiples of the largest error (calibrated on the virtual rigs 1 to 5).
OSCILLATION_SHARE = 2.0


@dataclass(frozen=True, eq=False)
class QuadraticFeedback:
    """torque = −gain·x + prefilter·speed_reference + load_gain·T_load + motor_gain·T_motor, with T_load = Coulomb
    friction of the load − torque_load and T_motor = Coulomb friction of the motor.

    ``gain`` is (n,) over ``states``, those of ``systems.design_model``; ``prefilter`` in Nm s/rad, ``load_gain`` and
    ``motor_gain`` without unit: with them none of the three leaves a steady error.
    """

    states: tuple[str, ...]
    gain: Array
    prefilter: float
    load_gain: float
    motor_gain: float


def wished_rows(
    law: str,
    model: DesignModel,
    largest_error: float,
    largest_torque: float,
    largest_oscillation: float | None,
    largest_twist: float,
) -> Array:
    """Rows (3, n) over the model's states of error, oscillation and twist, each in units of its wish (see ``lqi``)."""
    if largest_oscillation is None:
        largest_oscillation = OSCILLATION_SHARE * largest_error
    wishes = {
        "largest_error": largest_error, "largest_torque": largest_torque,
        "largest_oscillation": largest_oscillation, "largest_twist": largest_twist,
    }  # fmt: skip
    for name, value in wishes.items():
        finite = math.isfinite(value) or name in ("largest_oscillation", "largest_twist")
        if not (value > 0.0 and finite):
            raise InvalidInput(
                f"{law}.{name}", repr(value), "a positive number in SI units", "Check the unit."
            )
    return np.array([
        model.row(speed_load=1.0) / largest_error,
        model.row(speed_motor=1.0, speed_load=-1.0) / largest_oscillation,
        model.row(twist=1.0) / largest_twist,
    ])  # fmt: skip


def with_steady_state(drivetrain: Drivetrain, model: DesignModel, gain: Array) -> QuadraticFeedback:
    """The feedback of a gain (n,) over the model's states, with prefilter, load and motor gain."""
    # What holds a steady state: a torque at the motor shows in the actuator's states, one at the load in the twist too.
    torques = model.row(**{name: 1.0 for name in model.states if name.startswith("torque_")})
    motor_gain = 1.0 + float(gain @ torques)
    load_gain = motor_gain + float(gain[0]) / drivetrain.stiffness
    speeds = float(gain @ model.row(speed_motor=1.0, speed_load=1.0))
    prefilter = speeds + motor_gain * drivetrain.viscous_motor + load_gain * drivetrain.viscous
    return QuadraticFeedback(model.states, gain, prefilter, load_gain, motor_gain)


def signal_gains(drivetrain: Drivetrain, design: QuadraticFeedback, load_torque: bool) -> dict[str, float]:
    """What each input of ``lqi`` adds to the torque, by name and in their order."""
    k = dict(zip(design.states, design.gain, strict=True))
    gains = {
        "speed_reference": design.prefilter,
        "twist_elastic_estimated": -k["twist"],
        "speed_motor_estimated": -k["speed_motor"],
        # The prefilter carries the viscous part, so the friction's estimate gives its Coulomb part alone.
        "speed_load_estimated": -k["speed_load"] - design.load_gain * drivetrain.viscous,
        "friction_load_estimated": design.load_gain,
        "torque_motor_acting": -k["torque_last"],
    }
    if load_torque:
        gains["torque_load_estimated"] = -design.load_gain
    return gains


def actuator_gain(design: QuadraticFeedback) -> float:
    """What the current loop's torque adds to the torque; 0 where the drivetrain has no lag."""
    return -dict(zip(design.states, design.gain, strict=True)).get("torque_actuator", 0.0)


def feedback_law(
    name: str,
    drivetrain: Drivetrain,
    design: QuadraticFeedback,
    *,
    dt: float,
    torque_limit: float,
    load_torque: bool,
    further: dict[str, float] | None = None,
) -> DiscreteSystem:
    """The feedback as a law of that name; inputs and outputs as those of ``lqi``.

    ``further`` are inputs with their gains in the torque, for a feedforward.
    """
    gains = signal_gains(drivetrain, design, load_torque) | (further or {})
    motor = drivetrain.frictions[0]
    return limited_torque(
        name, gains, dt=dt, torque_limit=torque_limit,
        friction=(design.motor_gain * motor.coulomb_plus, design.motor_gain * motor.coulomb_minus),
        actuator_gain=actuator_gain(design), actuator=actuator_state(drivetrain, dt, tuple(gains)),
    )  # fmt: skip

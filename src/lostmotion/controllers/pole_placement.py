"""State feedback by pole placement, prefilter, Coulomb compensation (Fietzek & Rinderknecht, section V)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem, zero_order_hold
from .feedback.limited_torque import limited_torque

FrictionCompensation = Literal["estimated", "reference", "none"]

#: Poles of the state feedback, 1/s: Fietzek & Rinderknecht, section V.
DEFAULT_POLES = (-400.0, -400.0, -400.0)


@dataclass(frozen=True, eq=False)
class StateFeedback:
    """torque = −gain·(twist, speed_motor, speed_load) + prefilter·speed_reference +
    friction_gain·friction_load.

    ``gain`` is a (3,) array in Nm/rad and Nm s/rad, ``prefilter`` in Nm s/rad, ``friction_gain`` without
    unit: a constant friction torque of the load times this leaves its speed unchanged in steady state.
    """

    gain: NDArray[np.float64]
    prefilter: float
    friction_gain: float


@checks_arguments
def state_feedback(
    drivetrain: Drivetrain, poles: Sequence[complex] = DEFAULT_POLES, dt: float | None = None
) -> StateFeedback:
    """Gains that place the three poles of the two-mass drivetrain with the gap closed, by Ackermann's
    formula.

    Parameters
    ----------
    drivetrain : Drivetrain
        Its actuator lag is neglected; viscous friction is included. (The paper's K neglects viscous friction too.)
    poles : three numbers, 1/s
        Real or in conjugate pairs, with negative real parts. Default: Fietzek & Rinderknecht, section V.
    dt : float, s, optional
        Given: gains for a torque held over dt, which place exp(pole·dt). Default: continuous time.

    Raises
    ------
    InvalidInput
        If there are not three poles, they are not conjugate, or one is not stable.
    """
    wanted = _checked_poles(poles)
    a, b = drivetrain.linear()
    if dt is not None:
        a, b = zero_order_hold(a, b, dt)
        wanted = np.exp(wanted * dt)
    power, controllability, polynomial = np.eye(3), np.empty((3, 3)), np.zeros((3, 3))
    coefficients = np.real(np.poly(wanted))[::-1]
    for i in range(3):
        controllability[:, i] = (power @ b)[:, 0]
        polynomial += coefficients[i] * power
        power = power @ a
    polynomial += power
    gain = np.linalg.solve(controllability.T, np.array([0.0, 0.0, 1.0])) @ polynomial
    # In steady state all turns at the reference w: the motor torque is k·twist, which is the load's friction, plus
    # the motor's own friction.
    k, viscous = drivetrain.stiffness, drivetrain.viscous
    friction_gain = 1.0 + float(gain[0]) / k
    prefilter = float(gain[1] + gain[2]) + drivetrain.viscous_motor + friction_gain * viscous
    return StateFeedback(gain, prefilter, friction_gain)


@checks_arguments
def pole_placement(
    drivetrain: Drivetrain,
    *,
    poles: Sequence[complex] = DEFAULT_POLES,
    dt: float,
    torque_limit: float = math.inf,
    friction_compensation: FrictionCompensation = "estimated",
    load_torque: bool = False,
) -> DiscreteSystem:
    """Speed control of the load by feedback of the estimated **elastic** twist and speeds.

    With feedback of the whole twist the load would settle below the set-point, because backlash/2 times its
    gain is a constant torque. The gains are those for a held torque (``state_feedback`` with dt).

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    poles : three numbers, 1/s
    dt : float, s
    torque_limit : float, Nm
        inf: no limit.
    friction_compensation : {"estimated", "reference", "none"}
        Which load friction is compensated: the observer's estimate, which stays between the levels while the
        load sticks and therefore cannot chatter; or the Coulomb level in the direction of the set-point,
        linear within ±0.1 rad/s. Coulomb friction of the motor is compensated by the direction of the set-point
        in both.
    load_torque : bool
        Feed back the load torque of an observer that estimates it: the integral action. Without it a load torque, or
        friction that is not as in the model, leaves a steady error.

    Returns
    -------
    DiscreteSystem
        Inputs speed_reference, twist_elastic_estimated, speed_motor_estimated, speed_load_estimated, with "estimated"
        friction_load_estimated, and with ``load_torque`` torque_load_estimated; output torque_motor.

    Raises
    ------
    InvalidInput
        See ``state_feedback``; also for an unknown friction_compensation or a torque limit that is not
        positive.
    """
    if friction_compensation not in ("estimated", "reference", "none"):
        raise InvalidInput(
            "friction_compensation",
            repr(friction_compensation),
            "estimated, reference or none",
            "Choose one.",
        )
    design = state_feedback(drivetrain, poles, dt)
    gains = {
        "speed_reference": design.prefilter,
        "twist_elastic_estimated": -design.gain[0],
        "speed_motor_estimated": -design.gain[1],
        "speed_load_estimated": -design.gain[2],
    }
    if friction_compensation == "estimated":
        # The prefilter compensates the viscous part, so only the Coulomb part of the estimate is used.
        gains["speed_load_estimated"] -= design.friction_gain * drivetrain.viscous
        gains["friction_load_estimated"] = design.friction_gain
    if load_torque:
        gains["torque_load_estimated"] = -design.friction_gain
    levels = _levels_by_reference(drivetrain, design.friction_gain, friction_compensation)
    return limited_torque("pole_placement", gains, dt=dt, torque_limit=torque_limit, friction=levels)


def _checked_poles(poles: Sequence[complex]) -> NDArray[np.complex128]:
    values = np.array(poles, dtype=complex).ravel()
    conjugate = np.allclose(np.sort_complex(values), np.sort_complex(values.conj()), rtol=1e-9, atol=0.0)
    if values.size != 3 or not np.all(np.isfinite(values)) or not conjugate or np.any(values.real >= 0.0):
        raise InvalidInput(
            "poles",
            f"{list(poles)!r}",
            "three numbers with negative real parts in 1/s, complex ones in conjugate pairs",
            "For example (-400, -400, -400).",
        )
    return values


def _levels_by_reference(
    drivetrain: Drivetrain, friction_gain: float, compensation: str
) -> tuple[float, float]:
    """Torque (Nm) to add at positive set-points and to take off at negative ones."""
    if compensation == "none":
        return 0.0, 0.0
    motor, load = drivetrain.frictions
    share = friction_gain if compensation == "reference" else 0.0
    return motor.coulomb_plus + share * load.coulomb_plus, motor.coulomb_minus + share * load.coulomb_minus

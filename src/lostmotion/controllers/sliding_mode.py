"""Sliding-mode and super-twisting speed control: a sliding variable is held at zero against what is unknown."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..curves import PiecewiseLinear, saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from ..systems.checks import sample_time

Array = NDArray[np.float64]

#: Poles on the sliding surface, 1/s (calibrated on the virtual rigs 1 to 3: no overshoot, half as fast as the rate).
SURFACE_POLES = (-150.0, -150.0)
#: The sliding variable returns with this rate, as a share of 1/(lag + 1.5·dt): beyond it the delays make it swing
#: (calibrated on the virtual rigs 1 to 3).
RATE_SHARE = 0.25
#: Corners of the square root's chords, as shares of its range (numerics: at most 6 % above the lowest chord).
ROOT_POINTS = (0.0, 0.01, 0.04, 0.16, 0.36, 0.64, 1.0)

INPUTS = (
    "speed_reference", "twist_elastic_estimated", "speed_motor_estimated", "speed_load_estimated",
    "friction_load_estimated", "torque_load_estimated",
)  # fmt: skip


@checks_arguments
def sliding_mode(
    drivetrain: Drivetrain,
    *,
    dt: float,
    switching_torque: float,
    torque_limit: float,
    poles: Sequence[float] = SURFACE_POLES,
    rate: float | None = None,
) -> DiscreteSystem:
    """Sliding-mode speed control of the load with a boundary layer.

    ::

        s = speed_motor − speed_load + c₁·(twist_elastic − that which holds the load)
            + c₂·(speed_load − speed_reference)
        torque_motor = clip(equivalent torque − clip(inertia_motor·rate·s, ±switching_torque), ±torque_limit)

    c₁ and c₂ place the two poles of the motion on s = 0; the equivalent torque keeps s constant on the nominal plant.
    What is unknown may need up to ``switching_torque``. Within the boundary layer switching_torque/(inertia_motor·rate)
    the law is linear, so it cannot chatter faster than its rate.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
    switching_torque, torque_limit : float, Nm
    poles : two numbers, 1/s
        Real, negative.
    rate : float, 1/s
        With which s returns to zero; default ``RATE_SHARE``/(lag + 1.5·dt).

    Returns
    -------
    DiscreteSystem
        Inputs speed_reference, twist_elastic_estimated, speed_motor_estimated, speed_load_estimated,
        friction_load_estimated, torque_load_estimated; output torque_motor.

    Raises
    ------
    InvalidInput
        If there are not two masses, or a number is not positive (poles: negative).

    Notes
    -----
    Utkin, Guldner & Shi 2009, Sliding Mode Control in Electro-Mechanical Systems, chapters 2 and 8 (boundary layer).
    """
    sliding, equivalent, rate = _surface("sliding_mode", drivetrain, dt, poles, rate)
    _positive("sliding_mode", switching_torque=switching_torque, torque_limit=torque_limit)
    push = drivetrain.inertia_motor * rate * sliding
    return DiscreteSystem(
        inputs=INPUTS, outputs=("torque_motor",), dt=dt, name="sliding_mode",
        curves=(saturation(switching_torque), saturation(torque_limit)),
        G=np.array([-push, equivalent]), H=np.eye(2, k=-1), J=np.eye(1, 2, 1),
    )  # fmt: skip


@checks_arguments
def super_twisting(
    drivetrain: Drivetrain,
    *,
    dt: float,
    switching_torque: float,
    torque_limit: float,
    integral_rate: float,
    poles: Sequence[float] = SURFACE_POLES,
    rate: float | None = None,
) -> DiscreteSystem:
    """Super-twisting speed control of the load: a continuous torque, whose integral finds what is unknown.

    ::

        push = switching_torque·√(|s|/S)·sign(s)        S = switching_torque/(inertia_motor·rate)
        torque_motor = clip(equivalent torque − push + torque_integral, ±torque_limit)
        torque_integral⁺ = clip(torque_integral − dt·integral_rate·clip(s·100/S, ±1), ±switching_torque)

    The root is given by chords, the sign is linear within 1 % of S: so the law is data, and cannot chatter.

    Parameters
    ----------
    integral_rate : float, Nm/s
        Largest rate of the integral; it must exceed that of the unknown torque.
    others : as in ``sliding_mode``

    Returns
    -------
    DiscreteSystem
        As ``sliding_mode``, with the state torque_integral (Nm).

    Raises
    ------
    InvalidInput
        As ``sliding_mode``.

    Notes
    -----
    Levant 1993, Int. J. Control 58, 1247–1263.
    """
    sliding, equivalent, rate = _surface("super_twisting", drivetrain, dt, poles, rate)
    _positive(
        "super_twisting", switching_torque=switching_torque, torque_limit=torque_limit, integral_rate=integral_rate
    )  # fmt: skip
    scale = switching_torque / (drivetrain.inertia_motor * rate)
    root = [(share, math.sqrt(share)) for share in ROOT_POINTS[1:]]
    points = [(-a, -b) for a, b in reversed(root)] + [(0.0, 0.0)] + root
    push = PiecewiseLinear(tuple((scale * a, switching_torque * b) for a, b in points), 0.0, 0.0)
    near = ROOT_POINTS[1] * scale
    sign = saturation(dt * integral_rate, dt * integral_rate / near)
    zero = np.zeros(len(INPUTS))
    return DiscreteSystem(
        inputs=INPUTS, outputs=("torque_motor",), states=("torque_integral",), dt=dt, name="super_twisting",
        curves=(push, sign, saturation(torque_limit), saturation(switching_torque)),
        F=np.array([[0.0], [0.0], [1.0], [1.0]]), G=np.array([sliding, sliding, equivalent, zero]),
        # The push goes into the torque, the sign into the integral, both with a minus.
        H=-np.eye(4, k=-2), J=np.eye(1, 4, 2), E=np.eye(1, 4, 3),
    )  # fmt: skip


def _surface(
    law: str, drivetrain: Drivetrain, dt: float, poles: Sequence[float], rate: float | None
) -> tuple[Array, Array, float]:
    """Rows over ``INPUTS`` of the sliding variable (rad/s) and of the equivalent torque (Nm), and the rate."""
    dt = sample_time(f"{law}.dt", dt)
    values = np.array(poles, dtype=float).ravel()
    if values.size != 2 or not np.all(np.isfinite(values)) or np.any(values >= 0.0):
        raise InvalidInput(f"{law}.poles", repr(poles), "two negative numbers in 1/s", "Check the unit.")
    rate = RATE_SHARE / (drivetrain.lag + 1.5 * dt) if rate is None else rate
    _positive(law, rate=rate)
    stiffness, load, motor = drivetrain.stiffness, drivetrain.inertia_load, drivetrain.inertia_motor
    reference, twist, speed_motor, speed_load, friction, pull = np.eye(len(INPUTS))
    difference = speed_motor - speed_load
    # What is left of the shaft's torque accelerates the load; on s = 0 both move with the poles.
    wound = stiffness * twist - friction + pull
    product, total = float(values[0] * values[1]), -float(np.sum(values))
    sliding = difference + total * wound / stiffness + product * load / stiffness * (speed_load - reference)
    acceleration = wound / load
    # d(speed_motor)/dt that keeps s constant on the nominal plant, friction and set-point constant.
    needed = acceleration - total * difference - product * load / stiffness * acceleration
    equivalent = motor * needed + stiffness * twist
    return sliding, equivalent, rate


def _positive(law: str, **values: float) -> None:
    for name, value in values.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidInput(
                f"{law}.{name}", repr(value), "a positive number in SI units", "Check the unit."
            )

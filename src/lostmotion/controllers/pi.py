"""PI speed controller on the motor speed, as in frequency converters, with torque limit and anti-windup."""

from __future__ import annotations

import math

import numpy as np

from ..curves import saturation
from ..errors import InvalidInput
from ..systems import DiscreteSystem


def pi(*, dt: float, kp: float = 10.0, ki: float = 20.0, torque_limit: float = math.inf) -> DiscreteSystem:
    """PI speed controller of the **motor** speed.

    ::

        e = speed_reference − speed_motor
        torque_motor = clip(integral + kp·e, ±torque_limit)
        integral⁺ = integral + dt·ki·(kp·e + torque_motor − (integral + kp·e))

    The last difference is the anti-windup by back-calculation: it is zero within the limit, and beyond it
    leads the integral back with the time constant 1/ki of the controller's own zero (chosen).

    Parameters
    ----------
    dt : float, s
    kp : float, Nm s/rad
    ki : float, 1/s
        Relative to kp: the integral gain is ki·kp. Defaults: reading of Fietzek & Rinderknecht, Table II,
        that fits their Fig. 12 (kp 10 Nm s/rad, ki 20 1/s, so 200 Nm/rad).
    torque_limit : float, Nm
        inf: no limit, and no anti-windup.

    Returns
    -------
    DiscreteSystem
        Inputs speed_reference, speed_motor (rad/s); output torque_motor (Nm); state torque_integral (Nm).

    Raises
    ------
    InvalidInput
        If a number is not positive, or ki·dt ≥ 1, where the anti-windup itself would not settle.
    """
    for name, value in (("dt", dt), ("kp", kp), ("torque_limit", torque_limit)):
        if not value > 0.0 or (name != "torque_limit" and math.isinf(value)):
            raise InvalidInput(f"pi.{name}", repr(value), "a positive number in SI units", "Check the unit.")
    if not 0.0 <= ki * dt < 1.0:
        raise InvalidInput("pi.ki", f"{ki!r} 1/s", f"zero up to 1/dt = {1.0 / dt:g} 1/s", "Lower ki or dt.")
    proportional, step, one = np.array([[kp, -kp]]), dt * ki, np.ones((1, 1))
    names, states = ("speed_reference", "speed_motor"), ("torque_integral",)
    if math.isinf(torque_limit):
        return DiscreteSystem(
            inputs=names, outputs=("torque_motor",), states=states, dt=dt, name="pi",
            A=one, B=step * proportional, C=one, D=proportional,
        )  # fmt: skip
    # With z = integral + kp·e the update is integral + dt·ki·(w − integral): the proportional parts cancel.
    return DiscreteSystem(
        inputs=names, outputs=("torque_motor",), states=states, dt=dt, name="pi",
        curves=(saturation(torque_limit),), F=one, G=proportional, J=one, A=(1.0 - step) * one, E=step * one,
    )  # fmt: skip

"""PI speed controller on the motor speed, as in frequency converters, with torque limit and anti-windup."""

from __future__ import annotations

import math

import numpy as np

from ..curves import saturation
from ..errors import InvalidInput
from ..systems import DiscreteSystem


def pi(*, dt: float, kp: float = 10.0, ki: float = 200.0, torque_limit: float = math.inf) -> DiscreteSystem:
    """PI speed controller of the **motor** speed.

    ::

        e = speed_reference − speed_motor
        torque_motor = clip(integral + kp·e, ±torque_limit)
        integral⁺ = integral + dt·ki·e + dt·(ki/kp)·(torque_motor − (integral + kp·e))

    The last term is the anti-windup by back-calculation: it is zero within the limit, and beyond it
    returns the integral with the time constant kp/ki of the controller's own zero (chosen).

    Parameters
    ----------
    dt : float, s
    kp : float, Nm s/rad
    ki : float, Nm/rad
        Defaults: Fietzek & Rinderknecht, Table II, read so that it matches their Fig. 12.
    torque_limit : float, Nm
        inf: no limit, and no anti-windup.

    Returns
    -------
    DiscreteSystem
        Inputs speed_reference, speed_motor (rad/s); output torque_motor (Nm); state torque_integral (Nm).

    Raises
    ------
    InvalidInput
        If a number is not positive, or ki/kp·dt ≥ 1, where the anti-windup itself would not settle.
    """
    for name, value in (("dt", dt), ("kp", kp), ("torque_limit", torque_limit)):
        if not value > 0.0 or (name != "torque_limit" and math.isinf(value)):
            raise InvalidInput(f"pi.{name}", repr(value), "a positive number in SI units", "Check the unit.")
    if not 0.0 <= ki / kp * dt < 1.0:
        raise InvalidInput(
            "pi.ki", f"{ki!r} Nm/rad", f"zero up to kp/dt = {kp / dt:g} Nm/rad", "Lower ki or dt."
        )
    proportional, step, one = np.array([[kp, -kp]]), dt * (ki / kp), np.ones((1, 1))
    names, states = ("speed_reference", "speed_motor"), ("torque_integral",)
    if math.isinf(torque_limit):
        return DiscreteSystem(
            inputs=names, outputs=("torque_motor",), states=states, dt=dt, name="pi",
            A=one, B=step * proportional, C=one, D=proportional,
        )  # fmt: skip
    # With z = integral + kp·e the update is integral + dt·(ki/kp)·(w − integral): the proportional parts cancel.
    return DiscreteSystem(
        inputs=names, outputs=("torque_motor",), states=states, dt=dt, name="pi",
        curves=(saturation(torque_limit),), F=one, G=proportional, J=one, A=(1.0 - step) * one, E=step * one,
    )  # fmt: skip

"""PI speed controller on the motor speed, as in frequency converters, with torque limit and anti-windup."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments, not_negative
from ..curves import PiecewiseLinear, saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from .feedback.reference_direction import reference_direction


@checks_arguments
def pi(
    *,
    dt: float,
    kp: float = 10.0,
    ki: float = 200.0,
    torque_limit: float = math.inf,
    filter_time: float = 0.0,
    speed_filter_time: float = 0.0,
    friction_of: Drivetrain | None = None,
    realised_torque: bool = False,
) -> DiscreteSystem:
    """PI speed controller of the **motor** speed.

    ::

        e = reference − speed       reference: speed_reference through 1/(1 + filter_time·s)
                                    speed: speed_motor through 1/(1 + speed_filter_time·s)
        torque_motor = clip(integral + kp·e + friction(reference), ±torque_limit)
        integral⁺ = integral + dt·ki·e + dt·(ki/kp)·(torque_motor − (integral + kp·e + friction(reference)))

    The last term is the anti-windup by back-calculation: it is zero within the limit, and beyond it
    returns the integral with the time constant kp/ki of the controller's own zero (chosen). With ``realised_torque`` it
    is the torque that acts less the one that was wished for it a sample before: so a drive that gives less than it is
    asked for, hot or at low voltage, does not wind the integral up either.

    Parameters
    ----------
    dt : float, s
    kp : float, Nm s/rad
    ki : float, Nm/rad
        Defaults: Fietzek & Rinderknecht, Table II, read so that it matches their Fig. 12.
    torque_limit : float, Nm
        inf: no limit, and no anti-windup.
    filter_time : float, s
        Of the set-point filter; 0: none.
    speed_filter_time : float, s
        Of the filter of the measured speed, for coarse encoders and short samples; 0: none.
    friction_of : Drivetrain, optional
        Its Coulomb and viscous friction, of all inertias, is fed forward by the reference, linear within
        ±``REFERENCE_BAND``; default: none.
    realised_torque : bool
        Whether the drive reports the torque set-point that acts, see ``lqi``: with one sample of computing delay, what
        became of the last torque.

    Returns
    -------
    DiscreteSystem
        Inputs speed_reference, speed_motor (rad/s), and with ``realised_torque`` torque_motor_acting (Nm); output
        torque_motor (Nm); states torque_integral (Nm), with filters speed_reference_filtered and speed_motor_filtered
        (rad/s), and with ``realised_torque`` torque_wished (Nm).

    Raises
    ------
    InvalidInput
        If a number is not positive (the filters' times: zero or more), or ki/kp·dt ≥ 1, where the anti-windup itself
        would not settle.
    """
    _check(dt, kp, ki, torque_limit)
    times = {
        "speed_reference_filtered": not_negative("pi.filter_time", filter_time),
        "speed_motor_filtered": not_negative("pi.speed_filter_time", speed_filter_time),
    }
    decay = {name: math.exp(-dt / time) for name, time in times.items() if time > 0.0}
    states = ("torque_integral", *decay, *(("torque_wished",) if realised_torque else ()))
    inputs = ("speed_reference", "speed_motor", *(("torque_motor_acting",) if realised_torque else ()))
    signals = (*states, *inputs)
    one: dict[str, NDArray[np.float64]] = dict(zip(signals, np.eye(len(signals)), strict=True))
    integral, reference = one["torque_integral"], one.get("speed_reference_filtered", one["speed_reference"])
    updated = {
        name: share * one[name] + (1.0 - share) * one[name.removesuffix("_filtered")]
        for name, share in decay.items()
    }
    # The measured speed counts with its own sample: the filter costs no further delay.
    motor = updated.get("speed_motor_filtered", one["speed_motor"])
    unlimited, step, n = integral + kp * (reference - motor), dt * (ki / kp), len(states)
    curves: list[PiecewiseLinear] = [] if friction_of is None else [_friction(friction_of)]
    z, w = [reference] * len(curves), np.ones((1, len(curves)))
    wished, by_friction = unlimited, np.ones_like(w)
    # The integral goes towards what the torque leaves for it: with a limit that is the anti-windup.
    free = integral + dt * ki * (reference - motor)
    follows, by_curves = free, 0.0 * w
    if math.isfinite(torque_limit):
        curves.append(saturation(torque_limit))
        z, w = [*z, unlimited], np.eye(1, len(z) + 1, len(z))
        follows, by_curves = (1.0 - step) * integral, step * w - step * (1.0 - w)
        unlimited, by_friction = np.zeros(len(signals)), 1.0 - w
    if realised_torque:
        missing = one["torque_motor_acting"] - one["torque_wished"]
        follows, by_curves = free + step * missing, 0.0 * w
    arguments = np.array(z).reshape(len(z), len(signals))
    update = np.array([follows, *updated.values(), *([wished] if realised_torque else [])])
    by_others = np.zeros((n - 1, len(curves)))
    by_others[len(decay) :] = by_friction
    return DiscreteSystem(
        inputs=inputs, outputs=("torque_motor",), states=states, dt=dt, name="pi",
        curves=tuple(curves), F=arguments[:, :n], G=arguments[:, n:], H=np.eye(len(curves), k=-1),
        C=unlimited[None, :n], D=unlimited[None, n:], J=w,
        A=update[:, :n], B=update[:, n:], E=np.vstack([by_curves, by_others]),
    )  # fmt: skip


def _check(dt: float, kp: float, ki: float, torque_limit: float) -> None:
    for name, value in (("dt", dt), ("kp", kp), ("torque_limit", torque_limit)):
        if not value > 0.0 or (name != "torque_limit" and math.isinf(value)):
            raise InvalidInput(f"pi.{name}", repr(value), "a positive number in SI units", "Check the unit.")
    if not 0.0 <= ki / kp * dt < 1.0:
        raise InvalidInput(
            "pi.ki", f"{ki!r} Nm/rad", f"zero up to kp/dt = {kp / dt:g} Nm/rad", "Lower ki or dt."
        )


def _friction(drivetrain: Drivetrain) -> PiecewiseLinear:
    """Coulomb and viscous friction of all inertias over the speed, rad/s → Nm."""
    viscous = math.fsum(friction.viscous for friction in drivetrain.frictions)
    return reference_direction(
        math.fsum(friction.coulomb_plus for friction in drivetrain.frictions),
        math.fsum(friction.coulomb_minus for friction in drivetrain.frictions),
        viscous,
    )

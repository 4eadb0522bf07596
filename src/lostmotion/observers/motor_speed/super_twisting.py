"""Super-twisting observer: finds the torque that the model misses in finite time, without noise-driven switching."""

from __future__ import annotations

import math
from typing import Unpack

from ...drivetrain import Drivetrain
from ...kernels.estimators.layout import TWISTING_PARAMETERS
from ...systems import Stepper
from ..arguments import positive
from ..estimates import ESTIMATES
from ..filters.two_mass_parameters import stepper
from ..scale import scale_of
from .parameters import (
    Following,
    default_poles,
    error_of_counts,
    load_corrections,
    speed_only_parameters,
)

#: Numerics: largest share of the motor's error that a sample takes away, as ``parameters.FASTEST`` but for three poles.
FASTEST = 0.4

#: Option: defaults of the arguments on the paper's rig, Nm/s and Nm.
TORQUE_RATE, UNKNOWN_TORQUE = 3000.0, 20.0

OUTPUTS = (*ESTIMATES, "torque_unknown_estimated")


def super_twisting(
    drivetrain: Drivetrain,
    *,
    dt: float,
    torque_rate: float | None = None,
    unknown_torque: float | None = None,
    **following: Unpack[Following],
) -> Stepper:
    """Super-twisting observer from motor torque and motor speed.

    ::

        ν = dt·λ₁·|e|^½·sign(e) + s,   s⁺ = s + dt²·λ₂·sign(e),   e = y − ŷ,   λ₁ = 1.5·√L,   λ₂ = 1.1·L
        x⁺ = model(x, torque) + (l_twist·s, ν, l_load·s)

    with L = torque_rate/J_m. ``s`` converges to the motor acceleration that the model misses, in finite time; it
    corrects twist and load speed as in ``sliding_mode``.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
    torque_rate : float, Nm/s, optional
        How fast the torque that the model misses may change.
    unknown_torque : float, Nm, optional
        How large it may be. Defaults ``TORQUE_RATE`` and ``UNKNOWN_TORQUE`` on the paper's rig, for others by
        ``scale.scale_of``.
    **following
        As in ``sliding_mode``.

    Returns
    -------
    Stepper
        Inputs torque_motor, speed_motor; outputs ``OUTPUTS``: ``torque_unknown_estimated`` (Nm) is what the
        model misses on the motor; with the default bandwidth nothing of it goes into the load's speed.

    Raises
    ------
    InvalidInput
        For numbers out of range, as ``sliding_mode``.

    Notes
    -----
    Levant 1998, Automatica 34, 379–384 (gains 1.5 and 1.1); for backlash: Djeziri, Merzouki & Bouamama 2009, IEEE
    Trans. Vehicular Technology 58, 4710–4719. The sign is a line where it would correct more than the three
    equal poles that the sensor's noise allows. Defaults chosen.
    """
    p = speed_only_parameters(drivetrain, dt, following, TWISTING_PARAMETERS)
    jm = drivetrain.inertia_motor
    scale = scale_of(drivetrain)
    torque_rate = TORQUE_RATE * scale.torque * scale.rate if torque_rate is None else torque_rate
    unknown_torque = UNKNOWN_TORQUE * scale.torque if unknown_torque is None else unknown_torque
    bound = positive("torque_rate", torque_rate) / jm
    p["root"], p["integral"] = 1.5 * math.sqrt(bound) * dt, 1.1 * bound * dt**2
    p["bound"] = positive("unknown_torque", unknown_torque) / jm * dt
    # At the sensor's own noise the root counts as a gain; angle and integral are placed for three equal poles there.
    error = error_of_counts(p)
    share = min(math.sqrt(p["root"] / (3.0 * math.sqrt(error))), FASTEST)
    p["layer"] = max(p["integral"] / share**3, (p["root"] / (3.0 * share**2)) ** 2)
    p["to_angle"] = (1.0 - (1.0 - share) ** 3) * dt
    poles = default_poles(drivetrain, share, dt, following)
    p["to_twist"], p["to_load"] = load_corrections(drivetrain, *poles)
    p["inertia"] = jm / dt
    return stepper("super_twisting", OUTPUTS, ("speed_motor",), dt, p)

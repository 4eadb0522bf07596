"""Sliding-mode observer: the motor speed is forced onto its measurement, and the force tells the twist."""

from __future__ import annotations

import math
from typing import Unpack

from ...drivetrain import Drivetrain
from ...kernels.estimators.layout import SLIDING_PARAMETERS
from ...systems import Stepper
from ..arguments import positive
from ..estimates import ESTIMATES
from ..filters.two_mass_parameters import stepper
from ..scale import scale_of
from .parameters import (
    FASTEST,
    Following,
    default_poles,
    follow_share,
    load_corrections,
    speed_only_parameters,
)

#: Option: default of the argument on the paper's rig, Nm.
UNKNOWN_TORQUE = 10.0


def sliding_mode(
    drivetrain: Drivetrain,
    *,
    dt: float,
    unknown_torque: float | None = None,
    layer: float | None = None,
    **following: Unpack[Following],
) -> Stepper:
    """Sliding-mode observer from motor torque and motor speed.

    ::

        x⁺ = model(x, torque) + (l_twist, 1, l_load)·ν,   ν = dt·(unknown_torque/J_m)·sat((y − ŷ)/layer)

    The corrections of twist and load speed act only in contact, and not on a load that sticks.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
    unknown_torque : float, Nm, optional
        Largest torque on the motor that the model may miss and the correction still overcomes; default
        ``UNKNOWN_TORQUE`` on the paper's rig, for others by ``scale.scale_of``.
    layer : float, rad/s, optional
        Innovation at which the whole correction acts, linear below; default: so that below it the motor speed is
        followed as fast as its noise allows (``parameters.follow_share``).
    **following
        bandwidth, damping_ratio, sensor_noise, speed_from_counts: see ``parameters.Following``.

    Returns
    -------
    Stepper
        Inputs torque_motor, speed_motor; outputs ``estimates.ESTIMATES``.

    Raises
    ------
    InvalidInput
        For numbers out of range.

    Notes
    -----
    Merzouki & Cadiou 2005, Control Engineering Practice 13, 973–983: there the sliding correction is the estimate of
    the backlash's disturbing torque; here it corrects the model that contains the backlash. Defaults chosen.
    """
    p = speed_only_parameters(drivetrain, dt, following, SLIDING_PARAMETERS)
    if unknown_torque is None:
        unknown_torque = UNKNOWN_TORQUE * scale_of(drivetrain).torque
    reach = positive("unknown_torque", unknown_torque) / drivetrain.inertia_motor * dt
    share = follow_share(drivetrain, p)
    if layer is not None:
        share = min(math.sqrt(reach / positive("layer", layer)), FASTEST)
    p["reach"], p["layer"] = reach, reach / share**2 if layer is None else layer
    p["to_angle"] = share * (2.0 - share) * dt
    poles = default_poles(drivetrain, share, dt, following)
    p["to_twist"], p["to_load"] = load_corrections(drivetrain, *poles)
    return stepper("sliding_mode", ESTIMATES, ("speed_motor",), dt, p)

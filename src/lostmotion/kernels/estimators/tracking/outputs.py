"""Outputs of the filters that track parameters: estimates and their standard deviations."""

from __future__ import annotations

import math

from ...jit import njit
from ..kalman import variance_along
from ..layout import (
    BACKLASH,
    COULOMB,
    INVERSE_INERTIA_LOAD,
    INVERSE_INERTIA_MOTOR,
    MOVING,
    STIFFNESS,
    TORQUE_LOAD,
    TRACKED,
)
from ..sensors import OF_TORQUE_SHAFT
from ..two_mass_model import eigenmode_variance, write_estimates
from .measurement import predicted


@njit(cache=True)
def write(p, s, H, PHt, outputs):
    """All outputs, in the order of ``observers.filters.tracking_parameters``; H and PHt are scratch."""
    x, P = s.estimate.x, s.estimate.P
    predicted(p, x, P, OF_TORQUE_SHAFT, H)
    write_estimates(p, x, 0.5 * x[BACKLASH], s.friction, outputs)
    outputs[4] *= x[STIFFNESS]
    motor, load = p.inertia_motor / x[INVERSE_INERTIA_MOTOR], p.inertia_load / x[INVERSE_INERTIA_LOAD]
    outputs[6], outputs[7], outputs[8] = x[TORQUE_LOAD], x[BACKLASH], x[COULOMB]
    outputs[9], outputs[10], outputs[11] = p.stiffness * x[STIFFNESS], motor, load
    for i in range(3):
        outputs[12 + i] = math.sqrt(max(P[i, i], 0.0))
    eigenmodes = eigenmode_variance(p.eigenmode_share, p.eigenmode_rate, s.torque_moments, outputs[4])
    outputs[15] = math.sqrt(max(variance_along(P, H, PHt), 0.0) + eigenmodes)
    for i in range(TRACKED - MOVING):
        outputs[16 + i] = math.sqrt(max(P[MOVING + i, MOVING + i], 0.0))
    outputs[19] *= p.stiffness
    outputs[20] *= motor / x[INVERSE_INERTIA_MOTOR]
    outputs[21] *= load / x[INVERSE_INERTIA_LOAD]

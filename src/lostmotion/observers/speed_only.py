"""Parameters of the observers with one sensor, the motor speed, and corrections that only contact lets through."""

from __future__ import annotations

import math

import numpy as np

from ..drivetrain import Drivetrain
from .tuning import Array, model_parameters

#: The outputs that every observer has.
ESTIMATES = (
    "twist_estimated",
    "twist_elastic_estimated",
    "speed_motor_estimated",
    "speed_load_estimated",
    "torque_shaft_estimated",
    "friction_load_estimated",
)

#: An innovation beyond this is a jump, rad/s; it grows by that rate while no sample is believed, rad/s² (chosen).
LARGEST_INNOVATION, INNOVATION_RATE = 4.0, 800.0


def speed_only_parameters(
    drivetrain: Drivetrain, dt: float, sensor_noise: float, count_averaged: bool, own: int
) -> Array:
    """The parameters that ``kernels.steppers_speed_only`` reads, and room for ``own`` more."""
    from ..kernels import steppers_model as at
    from ..kernels import steppers_speed_only as kernel

    p = np.zeros(kernel.FREE + own)
    p[: at.OWN] = model_parameters(
        drivetrain, ("speed_motor",), dt, {"speed_motor": sensor_noise}, count_averaged
    )
    p[kernel.HALF], p[kernel.COULOMB] = 0.5 * drivetrain.backlash, drivetrain.coulomb
    p[kernel.EXPECTED] = LARGEST_INNOVATION / p[at.GATE]
    p[kernel.GROWTH] = INNOVATION_RATE * dt / p[at.GATE]
    return p


def load_corrections(drivetrain: Drivetrain, bandwidth: float, damping_ratio: float) -> tuple[float, float]:
    """Corrections of twist (s) and load speed per correction of the motor speed.

    Once the motor speed is followed, its correction ν shows the error of the twist, ν = −(k/J_m)·(twist error) with the
    gap closed. Feeding ν to both gives the errors of twist and load speed the poles s² + 2ζω s + ω².
    """
    k, jm, jl = drivetrain.stiffness, drivetrain.inertia_motor, drivetrain.inertia_load
    return -2.0 * damping_ratio * bandwidth * jm / k, (bandwidth**2 - k / jl) * jm / k


def default_bandwidth(drivetrain: Drivetrain) -> float:
    """Rate at which twist and load speed are corrected, 1/s: that of the load on the held shaft (chosen)."""
    return math.sqrt(drivetrain.stiffness / drivetrain.inertia_load)

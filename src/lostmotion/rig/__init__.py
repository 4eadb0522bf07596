"""The virtual test rig: a finer plant than the models fitted to it, with sensors."""

from .equivalent import eigenfrequencies, motor_zeros, two_mass_equivalent
from .finer import finer_rig
from .nominal import TORQUE_LIMIT, Rig, nominal_rig, varied_rig
from .record import Truth, record

__all__ = [
    "TORQUE_LIMIT",
    "Rig",
    "Truth",
    "eigenfrequencies",
    "finer_rig",
    "motor_zeros",
    "nominal_rig",
    "record",
    "two_mass_equivalent",
    "varied_rig",
]

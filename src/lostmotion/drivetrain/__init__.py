"""Drivetrain: inertias joined by shafts with stiffness, damping and backlash, with friction; frozen, SI units."""

from .actuator import Actuator
from .chain import PARAMETER_UNITS, Drivetrain
from .friction import Friction
from .gear import Gear
from .shaft import CONTACT_LAWS, Contact, Shaft

__all__ = [
    "CONTACT_LAWS",
    "PARAMETER_UNITS",
    "Actuator",
    "Contact",
    "Drivetrain",
    "Friction",
    "Gear",
    "Shaft",
]

"""Identification: from recordings to parameters, each with its interval and its source."""

from .backlash.locked_load import LockedBacklash, locked_backlash
from .backlash.torque_reversals import BacklashExcitation, backlash_excited
from .backlash.two_encoders import LostMotion, lost_motion
from .friction.breakaway import Breakaway, breakaway
from .friction.constant_speeds import FrictionLadder, friction_ladder
from .friction.inverse_dynamics import output_error_fit, rigid_drive, simulate_rigid_drive
from .friction.result import FrictionFit
from .friction.torque_step import torque_step
from .prediction_error.contact_comparison import ContactComparison, compare_contacts
from .prediction_error.identify import identify
from .prediction_error.result import Identification, Prediction
from .shaft.ring_down import RingDown, ring_down
from .shaft.stiffness import ShaftStiffness, shaft_stiffness

__all__ = [
    "BacklashExcitation",
    "Breakaway",
    "ContactComparison",
    "FrictionFit",
    "FrictionLadder",
    "Identification",
    "LockedBacklash",
    "LostMotion",
    "Prediction",
    "RingDown",
    "ShaftStiffness",
    "backlash_excited",
    "breakaway",
    "compare_contacts",
    "friction_ladder",
    "identify",
    "locked_backlash",
    "lost_motion",
    "output_error_fit",
    "rigid_drive",
    "ring_down",
    "shaft_stiffness",
    "simulate_rigid_drive",
    "torque_step",
]

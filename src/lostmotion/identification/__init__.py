"""Identification: from recordings to parameters, each with its interval and its source."""

from .backlash import LockedBacklash, locked_backlash
from .backlash_excitation import BacklashExcitation, backlash_excited
from .breakaway import Breakaway, breakaway
from .contacts import ContactComparison, compare_contacts
from .friction import FrictionFit
from .friction_ladder import FrictionLadder, friction_ladder
from .lost_motion import LostMotion, lost_motion
from .prediction_error import identify
from .result import Identification, Prediction
from .rigid_drive import refine_by_simulation, rigid_drive, simulate_rigid_drive
from .ring_down import RingDown, ring_down
from .shaft_stiffness import ShaftStiffness, shaft_stiffness
from .torque_step import torque_step

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
    "refine_by_simulation",
    "rigid_drive",
    "ring_down",
    "shaft_stiffness",
    "simulate_rigid_drive",
    "torque_step",
]

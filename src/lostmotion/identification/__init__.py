"""Identification: from recordings to parameters, each with its interval and its source."""

from .backlash.locked_load import LockedBacklash, locked_backlash
from .backlash.torque_reversals import BacklashExcitation, backlash_excited
from .backlash.two_encoders import LostMotion, lost_motion
from .frequency.analysis import FrequencyAnalysis, frequency_analysis
from .frequency.describing_functions import GaussianEquivalent, gaussian_equivalent
from .frequency.response import FrequencyResponse, frequency_response
from .frequency.tfestimate import mscohere, tfestimate
from .frequency.two_mass_fit import TwoMassFit, two_mass_fit
from .frequency.two_mass_response import two_mass_response
from .friction.breakaway import Breakaway, breakaway
from .friction.constant_speeds import FrictionLadder, friction_ladder
from .friction.evaluation import evaluate
from .friction.inverse_dynamics import output_error_fit, rigid_drive, simulate_rigid_drive
from .friction.result import FrictionFit
from .friction.torque_step import torque_step
from .prediction_error.contact_comparison import ContactComparison, compare_contacts
from .prediction_error.identify import identify
from .prediction_error.result import Identification, Prediction
from .shaft.ring_down import RingDown, ring_down
from .shaft.stiffness import ShaftStiffness, shaft_stiffness
from .statistics.estimates import UNITS, Estimates

__all__ = [
    "UNITS",
    "BacklashExcitation",
    "Breakaway",
    "ContactComparison",
    "Estimates",
    "FrequencyAnalysis",
    "FrequencyResponse",
    "FrictionFit",
    "FrictionLadder",
    "GaussianEquivalent",
    "Identification",
    "LockedBacklash",
    "LostMotion",
    "Prediction",
    "RingDown",
    "ShaftStiffness",
    "TwoMassFit",
    "backlash_excited",
    "breakaway",
    "compare_contacts",
    "evaluate",
    "frequency_analysis",
    "frequency_response",
    "friction_ladder",
    "gaussian_equivalent",
    "identify",
    "locked_backlash",
    "lost_motion",
    "mscohere",
    "output_error_fit",
    "rigid_drive",
    "ring_down",
    "shaft_stiffness",
    "simulate_rigid_drive",
    "tfestimate",
    "torque_step",
    "two_mass_fit",
    "two_mass_response",
]

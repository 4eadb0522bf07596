"""Identification: from recordings to parameters, each with its interval and its source."""

from .backlash_excitation import BacklashExcitation, backlash_excited
from .prediction_error import identify
from .result import Identification, Prediction
from .ring_down import RingDown, ring_down
from .shaft_stiffness import ShaftStiffness, shaft_stiffness

__all__ = [
    "BacklashExcitation",
    "Identification",
    "Prediction",
    "RingDown",
    "ShaftStiffness",
    "backlash_excited",
    "identify",
    "ring_down",
    "shaft_stiffness",
]

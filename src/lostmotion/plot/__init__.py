"""Figures of results and drawings of drives and laws: they change no global setting and return the Figure."""

from __future__ import annotations

from .control_step import control_step
from .drawings.block_diagram import block_diagram
from .drawings.chain import chain
from .drawings.reduction import reduction
from .frequency.bode import bode
from .frequency.coherence import coherence
from .frequency.mode_shapes import mode_shapes
from .identification.backlash_locked import backlash_locked
from .identification.backlash_lost_motion import backlash_lost_motion
from .identification.friction_curve import friction_curve
from .identification.friction_fit import friction_fit
from .identification.identified_parameters import identified_parameters
from .identification.prediction_fit import prediction_fit
from .identification.ring_down_fit import ring_down_fit
from .identification.stiffness_fit import stiffness_fit
from .limit_cycle_map import limit_cycle_map
from .loop_timing import loop_timing
from .observers.estimate_errors import estimate_errors
from .observers.leaderboard import leaderboard
from .observers.observer_step import observer_step
from .observers.sensor_worth import sensor_worth
from .quantile_bands import quantile_bands
from .recording_overview import recording_overview
from .stability_range import stability_range
from .style import source_of, words

__all__ = [
    "backlash_locked",
    "backlash_lost_motion",
    "block_diagram",
    "bode",
    "chain",
    "coherence",
    "control_step",
    "estimate_errors",
    "friction_curve",
    "friction_fit",
    "identified_parameters",
    "leaderboard",
    "limit_cycle_map",
    "loop_timing",
    "mode_shapes",
    "observer_step",
    "prediction_fit",
    "quantile_bands",
    "recording_overview",
    "reduction",
    "ring_down_fit",
    "sensor_worth",
    "source_of",
    "stability_range",
    "stiffness_fit",
    "words",
]

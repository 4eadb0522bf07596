"""Figures: they take data and optional Axes, change no global setting, and return the Figure."""

from __future__ import annotations

from .backlash_locked import backlash_locked
from .backlash_lost_motion import backlash_lost_motion
from .control_step import control_step
from .estimate_errors import estimate_errors
from .friction_curve import friction_curve
from .friction_fit import friction_fit
from .identified_parameters import identified_parameters
from .leaderboard import leaderboard
from .observer_step import observer_step
from .prediction_fit import prediction_fit
from .quantile_bands import quantile_bands
from .recording_overview import recording_overview
from .ring_down_fit import ring_down_fit
from .sensor_worth import sensor_worth
from .stiffness_fit import stiffness_fit

__all__ = [
    "backlash_locked",
    "backlash_lost_motion",
    "control_step",
    "estimate_errors",
    "friction_curve",
    "friction_fit",
    "identified_parameters",
    "leaderboard",
    "observer_step",
    "prediction_fit",
    "quantile_bands",
    "recording_overview",
    "ring_down_fit",
    "sensor_worth",
    "stiffness_fit",
]

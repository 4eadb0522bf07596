"""All steppers of the package by their kind: module, numbers of parameters and outputs."""

from __future__ import annotations

from . import scheduled_feedback
from .estimators import layout
from .predictive import layout as predictive

_ESTIMATORS = "lostmotion.kernels.estimators"

#: Kind → module with its ``init`` and ``step``.
MODULES = {
    "extended_kalman": f"{_ESTIMATORS}.extended_kalman",
    "hybrid_predictive": "lostmotion.kernels.predictive.hybrid",
    "interacting_models": f"{_ESTIMATORS}.interacting_models.step",
    "moving_horizon": f"{_ESTIMATORS}.moving_horizon.step",
    "neural_network": f"{_ESTIMATORS}.motor_speed.neural_network",
    "scheduled_feedback": "lostmotion.kernels.scheduled_feedback",
    "sliding_mode": f"{_ESTIMATORS}.motor_speed.sliding_mode",
    "super_twisting": f"{_ESTIMATORS}.motor_speed.super_twisting",
    "unscented_kalman": f"{_ESTIMATORS}.unscented_kalman",
}

#: Kind → place of the parameter that no output exceeds. (Layout.)
LIMITS = {"hybrid_predictive": predictive.LIMIT, "scheduled_feedback": scheduled_feedback.LIMIT}

#: Numbers of parameters and outputs: a step reads and writes its arrays at fixed places, whatever their lengths are.
#: (Layout.)
SIZES = {
    "extended_kalman": (layout.size(layout.PARAMETERS), 22),
    "hybrid_predictive": (predictive.PARAMETERS, 1),
    "interacting_models": (layout.size(layout.INTERACTING_PARAMETERS), 17),
    "moving_horizon": (layout.size(layout.HORIZON_PARAMETERS), 22),
    "neural_network": (layout.size(layout.NETWORK_PARAMETERS), 7),
    "scheduled_feedback": (scheduled_feedback.PARAMETERS, 1),
    "sliding_mode": (layout.size(layout.SLIDING_PARAMETERS), 6),
    "super_twisting": (layout.size(layout.TWISTING_PARAMETERS), 7),
    "unscented_kalman": (layout.size(layout.PARAMETERS), 22),
}

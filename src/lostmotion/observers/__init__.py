"""Observers: each file makes one kind, as a DiscreteSystem or a Stepper."""

from .covariances import Covariances, covariances
from .deviations import deviations
from .disturbance import disturbance
from .extended_kalman import extended_kalman
from .h_infinity import h_infinity
from .interacting_models import interacting_models
from .kalman import kalman, kalman_gain
from .moving_horizon import moving_horizon
from .radial_basis import radial_basis
from .shaft_torque import shaft_torque
from .sliding_mode import sliding_mode
from .super_twisting import super_twisting
from .unscented_kalman import unscented_kalman

__all__ = [
    "Covariances",
    "covariances",
    "deviations",
    "disturbance",
    "extended_kalman",
    "h_infinity",
    "interacting_models",
    "kalman",
    "kalman_gain",
    "moving_horizon",
    "radial_basis",
    "shaft_torque",
    "sliding_mode",
    "super_twisting",
    "unscented_kalman",
]

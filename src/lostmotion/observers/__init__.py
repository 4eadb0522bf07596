"""Observers: each file makes one kind, as a DiscreteSystem or a Stepper."""

from .analysis.covariances import Covariances, covariances
from .analysis.standard_deviations import standard_deviations
from .filters.extended_kalman import extended_kalman
from .filters.interacting_models import interacting_models
from .filters.moving_horizon import moving_horizon
from .filters.tuning import speed_of_counts
from .filters.unscented_kalman import unscented_kalman
from .fixed_gain.disturbance_observer import disturbance_observer
from .fixed_gain.h_infinity import h_infinity
from .fixed_gain.kalman import kalman, kalman_gain
from .fixed_gain.shaft_torque import shaft_torque
from .motor_speed.neural_network import neural_network
from .motor_speed.sliding_mode import sliding_mode
from .motor_speed.super_twisting import super_twisting

__all__ = [
    "Covariances",
    "covariances",
    "disturbance_observer",
    "extended_kalman",
    "h_infinity",
    "interacting_models",
    "kalman",
    "kalman_gain",
    "moving_horizon",
    "neural_network",
    "shaft_torque",
    "sliding_mode",
    "speed_of_counts",
    "standard_deviations",
    "super_twisting",
    "unscented_kalman",
]

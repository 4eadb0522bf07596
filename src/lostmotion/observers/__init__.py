"""Observers: each file makes one kind, as a DiscreteSystem."""

from .covariances import Covariances, covariances
from .disturbance import disturbance
from .h_infinity import h_infinity
from .kalman import kalman, kalman_gain
from .shaft_torque import shaft_torque

__all__ = ["Covariances", "covariances", "disturbance", "h_infinity", "kalman", "kalman_gain", "shaft_torque"]

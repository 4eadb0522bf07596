"""Observers: each file makes one kind, as a DiscreteSystem."""

from .kalman import kalman, kalman_gain

__all__ = ["kalman", "kalman_gain"]

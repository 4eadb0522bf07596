"""Exact simulation of drivetrains with backlash and set-valued friction, with or without a law in the loop."""

from .sensors import Sensor, measure
from .simulate import simulate

__all__ = ["Sensor", "measure", "simulate"]

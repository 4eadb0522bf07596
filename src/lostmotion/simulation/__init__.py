"""Exact simulation of drivetrains with backlash and set-valued friction, with or without a law in the loop."""

from .batch import BatchResult, read_trajectories, simulate_batch
from .sensors import Sensor, measure
from .simulate import simulate
from .variants import variants

__all__ = ["BatchResult", "Sensor", "measure", "read_trajectories", "simulate", "simulate_batch", "variants"]

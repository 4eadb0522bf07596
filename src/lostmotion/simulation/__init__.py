"""Exact simulation of drivetrains with backlash and set-valued friction, with or without a law in the loop."""

from .simulate import simulate

__all__ = ["simulate"]

"""The design of a test before it is run: the torque to play within limits, and how well it will tell each parameter."""

from .design import ExcitationDesign, design_excitation

__all__ = ["ExcitationDesign", "design_excitation"]

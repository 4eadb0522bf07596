"""The design of a test before it is run: a torque within limits, and the expected interval of each parameter."""

from .design import ExcitationDesign, design_excitation

__all__ = ["ExcitationDesign", "design_excitation"]

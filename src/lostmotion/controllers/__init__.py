"""Controllers: each file makes one control law, as a DiscreteSystem."""

from .pi import pi
from .pole_placement import StateFeedback, pole_placement, state_feedback

__all__ = ["StateFeedback", "pi", "pole_placement", "state_feedback"]

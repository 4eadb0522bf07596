"""Controllers: each file makes one control law, as a DiscreteSystem."""

from .active_damping import active_damping
from .lqi import QuadraticFeedback, lqi, quadratic_feedback
from .pi import pi
from .pi_tuning import PiTuning, symmetrical_optimum
from .pole_placement import StateFeedback, pole_placement, state_feedback
from .soft_landing import soft_landing

__all__ = [
    "PiTuning", "QuadraticFeedback", "StateFeedback", "active_damping", "lqi", "pi", "pole_placement",
    "quadratic_feedback", "soft_landing", "state_feedback", "symmetrical_optimum",
]  # fmt: skip

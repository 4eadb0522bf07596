"""Controllers: each file makes one law, as a DiscreteSystem or (planning across the gap, scheduled gains) a Stepper."""

from .active_damping import active_damping
from .feedback.feedback_law import QuadraticFeedback
from .flatness import flatness, speed_course
from .h_infinity import RobustFeedback, h_infinity, robust_feedback
from .hybrid_predictive import hybrid_predictive
from .lqi import lqi, quadratic_feedback
from .notch import notch
from .pi import pi
from .pole_placement import StateFeedback, pole_placement, state_feedback
from .predictive import predictive
from .quadratic_poles import quadratic_poles
from .scheduled_lqi import scheduled_lqi
from .sliding_mode import sliding_mode, super_twisting
from .soft_landing import soft_landing
from .torque_ramp import torque_ramp
from .tuning.optimised_pi import OptimisedPi, optimised_pi
from .tuning.symmetrical_optimum import PiTuning, symmetrical_optimum

__all__ = [
    "OptimisedPi", "PiTuning", "QuadraticFeedback", "RobustFeedback", "StateFeedback", "active_damping", "flatness",
    "h_infinity", "hybrid_predictive", "lqi", "notch", "optimised_pi", "pi", "pole_placement", "predictive",
    "quadratic_feedback", "quadratic_poles", "robust_feedback", "scheduled_lqi", "sliding_mode", "soft_landing",
    "speed_course", "state_feedback", "super_twisting", "symmetrical_optimum", "torque_ramp",
]  # fmt: skip

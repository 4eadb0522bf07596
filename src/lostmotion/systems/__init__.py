"""Discrete laws as data: the types, how to join several of them, and how to get there from continuous time."""

from .connect import connect
from .design_model import DesignModel, SteadyState, design_model, steady_state
from .discrete_system import DiscreteSystem
from .discretisation import one_sample_delay, zero_order_hold
from .input_check import InputCheck
from .limits import maximum, minimum, rate_limit
from .linearisation import linearised
from .loop_margin import LoopMargin, loop_margin
from .pruning import pruned
from .stepper import Stepper

__all__ = [
    "DesignModel", "DiscreteSystem", "InputCheck", "LoopMargin", "SteadyState", "Stepper", "connect", "design_model",
    "linearised", "loop_margin", "maximum", "minimum", "one_sample_delay", "pruned", "rate_limit", "steady_state",
    "zero_order_hold",
]  # fmt: skip

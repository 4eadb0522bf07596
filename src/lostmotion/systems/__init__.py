"""Discrete laws as data: the types, how to join several of them, and how to get there from continuous time."""

from .connect import connect
from .discrete_system import DiscreteSystem
from .discretisation import one_sample_delay, zero_order_hold
from .input_check import InputCheck
from .stepper import Stepper

__all__ = ["DiscreteSystem", "InputCheck", "Stepper", "connect", "one_sample_delay", "zero_order_hold"]

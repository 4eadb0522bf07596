"""What the templates need of a stepper: its step as C functions, its numbers, its memory."""

from __future__ import annotations

from typing import Any

from ..systems import Stepper
from .facts import spelling
from .kernel_source import c_functions


def stepper_context(law: Stepper, name: str, real: str) -> dict[str, Any]:
    """For ``stepper.c.jinja``, and for header and README as those of a DiscreteSystem."""
    start = law.functions.init(law.parameters.copy())
    return {
        **spelling(law, name, real),
        "states": range(start.size),
        "initial_state": [repr(float(value)) for value in start],
        "parameters_in_order": [repr(float(value)) for value in law.parameters],
        "functions": c_functions(law.functions.step, f"{name}_real"),
        "step": law.functions.step.py_func.__name__,
        "checks": [],
        "remembering": 0,
        "only_double": True,
    }

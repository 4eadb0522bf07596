"""lostmotion: from a recording to an identified drivetrain with backlash, observer, controller, and C code."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .version import VERSION

if TYPE_CHECKING:
    from . import (
        compare,
        controllers,
        export,
        identification,
        io,
        metrics,
        observers,
        plot,
        report,
        rig,
        signals,
        structure,
    )
    from .curves import PiecewiseLinear
    from .drivetrain import Actuator, Drivetrain, Friction, Gear, Shaft
    from .errors import InputProblems, InvalidInput, LostMotionError, Problem
    from .identification import Identification, identify, ring_down, shaft_stiffness
    from .io import (
        load_drivetrain,
        load_law,
        load_recording,
        read_recording,
        save_drivetrain,
        save_law,
        save_recording,
    )
    from .recording import Event, Recording
    from .simulation import BatchResult, Sensor, simulate, simulate_batch
    from .systems import DiscreteSystem, Stepper, connect, one_sample_delay

__version__ = VERSION

# Public names and the module that holds each, loaded when first used: importing the package stays fast.
_HOME = {
    "Actuator": "drivetrain",
    "BatchResult": "simulation",
    "DiscreteSystem": "systems",
    "Drivetrain": "drivetrain",
    "Event": "recording",
    "Friction": "drivetrain",
    "Gear": "drivetrain",
    "Identification": "identification",
    "InputProblems": "errors",
    "InvalidInput": "errors",
    "LostMotionError": "errors",
    "PiecewiseLinear": "curves",
    "Problem": "errors",
    "Recording": "recording",
    "Sensor": "simulation",
    "Shaft": "drivetrain",
    "Stepper": "systems",
    "connect": "systems",
    "identify": "identification",
    "load_drivetrain": "io",
    "load_law": "io",
    "load_recording": "io",
    "one_sample_delay": "systems",
    "read_recording": "io",
    "ring_down": "identification",
    "save_drivetrain": "io",
    "save_law": "io",
    "save_recording": "io",
    "shaft_stiffness": "identification",
    "simulate": "simulation",
    "simulate_batch": "simulation",
}
_FOLDERS = (
    "compare", "controllers", "export", "identification", "io", "metrics", "observers", "plot", "report", "rig",
    "signals", "structure",
)  # fmt: skip

__all__ = [
    "Actuator", "BatchResult", "DiscreteSystem", "Drivetrain", "Event", "Friction", "Gear",
    "Identification", "InputProblems", "InvalidInput", "LostMotionError", "PiecewiseLinear", "Problem",
    "Recording", "Sensor", "Shaft", "Stepper", "compare", "connect", "controllers", "export", "identification",
    "identify", "io", "load_drivetrain", "load_law", "load_recording", "metrics", "observers",
    "one_sample_delay", "plot", "read_recording", "report", "rig", "ring_down", "save_drivetrain",
    "save_law", "save_recording", "shaft_stiffness", "signals", "simulate", "simulate_batch", "structure",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name in _HOME:
        value = getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
    elif name in _FOLDERS:
        value = importlib.import_module(f".{name}", __name__)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

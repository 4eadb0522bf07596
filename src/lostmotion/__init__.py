"""lostmotion: from a recording to an identified drivetrain with backlash, observer, controller, and C code."""

from __future__ import annotations

from .version import VERSION

# Known to type checkers by its name. ``typing`` takes longer to import than Python to start, and an interruption of the
# command is not reported in one line before it is through here.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from . import (
        certificates,
        compare,
        controllers,
        curves,
        drivetrain,
        errors,
        experiment,
        export,
        identification,
        io,
        metrics,
        observers,
        paper,
        plot,
        realtime,
        recording,
        report,
        rig,
        signals,
        simulation,
        structure,
        systems,
    )
    from .curves import PiecewiseLinear
    from .drivetrain import Actuator, Drivetrain, Friction, Gear, Shaft
    from .errors import InputProblems, InvalidInput, LostMotionError, Problem
    from .events import Event
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
    from .recording import Recording
    from .simulation import BatchResult, Sensor, simulate, simulate_batch
    from .systems import DiscreteSystem, Stepper, connect, one_sample_delay

__version__ = VERSION

# Public names and the module that holds each, loaded when first used: importing the package stays fast.
_HOME = {
    "Actuator": "drivetrain",
    "BatchResult": "simulation",
    "DiscreteSystem": "systems",
    "Drivetrain": "drivetrain",
    "Event": "events",
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
#: The public rooms. What the documentation uses is importable from here or from one of these.
_ROOMS = (
    "certificates", "compare", "controllers", "curves", "drivetrain", "errors", "experiment", "export",
    "identification", "io", "metrics", "observers", "paper", "plot", "realtime", "recording", "report", "rig",
    "signals",
    "simulation", "structure", "systems",
)  # fmt: skip

__all__ = [
    "Actuator", "BatchResult", "DiscreteSystem", "Drivetrain", "Event", "Friction", "Gear", "Identification",
    "InputProblems", "InvalidInput", "LostMotionError", "PiecewiseLinear", "Problem", "Recording", "Sensor",
    "Shaft", "Stepper", "certificates", "compare", "connect", "controllers", "curves", "drivetrain", "errors",
    "experiment", "export", "identification", "identify", "io", "load_drivetrain", "load_law",
    "load_recording", "metrics", "observers", "one_sample_delay", "paper", "plot", "read_recording", "realtime",
    "recording", "report", "rig", "ring_down", "save_drivetrain", "save_law", "save_recording", "shaft_stiffness",
    "signals", "simulate", "simulate_batch", "simulation", "structure", "systems",
]  # fmt: skip


if not TYPE_CHECKING:  # a type checker sees the imports above, and that nothing else is here

    def __getattr__(name: str) -> object:
        import importlib

        if name in _HOME:
            value = getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
        elif name in _ROOMS:
            value = importlib.import_module(f".{name}", __name__)
        else:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

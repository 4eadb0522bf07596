"""The inputs of a plant: which there can be, and the checks of what is given."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput


def possible_inputs(drivetrain: Drivetrain) -> tuple[str, ...]:
    """All inputs that a plant can have: torques, and the acceleration of an end that is moved."""
    by_index = (f"torque_{i + 1}" for i in range(len(drivetrain.inertias)))
    moved = () if drivetrain.locked is None else (f"acceleration_{drivetrain.locked}",)
    return ("torque_motor", "torque_load", *by_index, *moved)


def plant_inputs(drivetrain: Drivetrain, signals: Mapping[str, Any]) -> tuple[str, ...]:
    """The plant's inputs: the motor torque, and what else is given."""
    return tuple(name for name in possible_inputs(drivetrain) if name == "torque_motor" or name in signals)


def last_set_point(state: Any) -> float:
    """Torque set-point before the first sample: that of the recording which is gone on from."""
    return float(state.get("torque_motor", 0.0)) if isinstance(state, Mapping) else 0.0


def check_sample_time(dt: float) -> None:
    if not (math.isfinite(dt) and dt > 0.0):
        raise InvalidInput("simulate.dt", repr(dt), "a positive sample time in s", "Give the sample time.")


def check_signal(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """A one-dimensional finite signal."""
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or array.size < 2:
        raise InvalidInput(
            name, f"shape {array.shape}", "a one-dimensional array of two or more samples", "Reshape."
        )
    finite = np.isfinite(array)
    if not finite.all():
        bad = np.flatnonzero(~finite)
        raise InvalidInput(
            name,
            f"{array[bad[0]]} in sample {bad[0]}",
            "finite numbers",
            "Remove or interpolate bad samples.",
        )
    return np.ascontiguousarray(array)


def check_lengths(signals: Mapping[str, NDArray[np.float64]]) -> int:
    lengths = {name: values.size for name, values in signals.items()}
    if len(set(lengths.values())) != 1:
        raise InvalidInput("simulate", f"lengths {lengths}", "signals of one length", "Crop or extend them.")
    return next(iter(lengths.values()))

"""The inputs of a plant: which there can be, and the checks of what is given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..plain_data import number, shown

#: Largest size of a signal and of a start, SI: that of a law's inputs (``kernels.law.machine_code.INPUT_BOUND``).
#: (Numerics.)
LARGEST = 1e30
#: Longest sample, s (option: an undamped shaft of the paper's rig swings 10 000 times in it, which takes 0.1 s).
LONGEST_SAMPLE = 100.0
#: Shortest sample, s (numerics: a shaft of 1e12 Hz turns by a radian in it).
SHORTEST_SAMPLE = 1e-13


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
    """A positive number of seconds; over very long samples a plant swings a million times."""
    if not SHORTEST_SAMPLE <= number("simulate.dt", dt) <= LONGEST_SAMPLE:
        raise InvalidInput(
            "simulate.dt",
            repr(dt),
            f"a positive sample time in s, of at most {LONGEST_SAMPLE:g} s and at least {SHORTEST_SAMPLE:g} s",
            "Give the sample time.",
        )


def check_signal(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """A one-dimensional signal of finite numbers of a size that can be calculated with."""
    try:
        array = np.asarray(values)
    except (ValueError, OverflowError):  # lists of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "fiub":
        raise InvalidInput(name, shown(values), "numbers", "Give an array of numbers.")
    if array.ndim != 1 or array.size < 2:
        raise InvalidInput(
            name, f"shape {array.shape}", "a one-dimensional array of two or more samples", "Reshape."
        )
    array = array.astype(float, copy=False)
    if not (array.min() >= -LARGEST and array.max() <= LARGEST):  # a NaN is the smallest and the largest
        bad = np.flatnonzero(~(np.abs(array) <= LARGEST))
        raise InvalidInput(
            name,
            f"{array[bad[0]]} in sample {bad[0]}",
            f"finite numbers of at most {LARGEST:g}",
            "Remove or interpolate bad samples.",
        )
    return np.ascontiguousarray(array)


def check_state(state: Any) -> None:
    """Numbers of a start of a size that can be calculated with; its shape is checked where the plant is known."""
    values = state.get("state", ()) if isinstance(state, Mapping) else state
    if values is None:
        return
    if isinstance(values, str) or not np.iterable(values):
        raise InvalidInput("simulate.state", shown(values), "twists, then speeds", "Give a row of numbers.")
    for i, value in enumerate(values):
        if not abs(number(f"simulate.state[{i}]", value)) <= LARGEST:
            raise InvalidInput(
                f"simulate.state[{i}]", shown(value), f"at most {LARGEST:g} rad or rad/s", "Check the unit."
            )


def check_lengths(signals: Mapping[str, NDArray[np.float64]]) -> int:
    lengths = {name: values.size for name, values in signals.items()}
    if len(set(lengths.values())) != 1:
        raise InvalidInput("simulate", f"lengths {lengths}", "signals of one length", "Crop or extend them.")
    return next(iter(lengths.values()))

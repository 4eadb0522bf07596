"""An end of the chain that is moved: its given angle and speed as what the plant needs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .contact_states import Layout

Array = NDArray[np.float64]

#: Largest difference between the slope of a given angle and the mean of the given speeds, as a part of the largest
#: speed, up to which they count as one motion (numerics: a sine of 1/20 of the sample rate differs by 0.8 %).
_CONSISTENT = 0.01


@dataclass(frozen=True, eq=False)
class MovedEnd:
    """The motion of a held end.

    Parameters
    ----------
    inertia : int
        Index of the end.
    speed : (n,) array, rad/s
        At the start of each sample.
    acceleration : (n,) array, rad/s²
        Held over each sample.
    angle : float or None, rad
        At the start; None: as the plant's state has it.
    jumps : bool
        Whether the speed at the end of a sample may differ from that at the start of the next.
    """

    inertia: int
    speed: Array
    acceleration: Array
    angle: float | None
    jumps: bool

    def place(self, layout: Layout, s: Array) -> None:
        """Puts the end at its given angle: the plant's state s turns as a whole."""
        if self.angle is not None:
            behind = sum(s[layout.twist(i)] for i in range(self.inertia))
            s[layout.angle_motor] = self.angle + behind


def started(
    drivetrain: Drivetrain, state: Sequence[float] | Mapping[str, Any] | None, moved: MovedEnd | None
) -> Sequence[float] | Mapping[str, Any] | None:
    """The start state with the held end's speed: that which it is given, or none."""
    if drivetrain.locked_inertia is None:
        return state
    n, speed = len(drivetrain.inertias), 0.0 if moved is None else float(moved.speed[0])
    place = n - 1 + drivetrain.locked_inertia
    if isinstance(state, Mapping):
        numbers = [float(v) for v in state.get("state", ())]
        numbers[place : place + 1] = [speed]
        return {**state, "state": tuple(numbers)}
    start = np.zeros(2 * n - 1) if state is None else np.array(state, dtype=float)
    if start.shape == (2 * n - 1,):
        start[place] = speed
    return [float(v) for v in start] if start.ndim == 1 else state


def moved_end(drivetrain: Drivetrain, dt: float, values: Mapping[str, Array]) -> MovedEnd | None:
    """The motion of the held end out of the given signals; None where it is not moved.

    A speed alone is linear from sample to sample; an angle alone likewise, so that the speed jumps at the samples.
    Given both, the angle holds at every sample, and the speed changes over a sample as given.

    Raises
    ------
    InvalidInput
        If lengths differ, or angle and speed do not belong to one motion.
    """
    if drivetrain.locked is None:
        return None
    speed, angle = (values.get(f"{kind}_{drivetrain.locked}") for kind in ("speed", "angle"))
    inertia = drivetrain.locked_inertia or 0
    if angle is None:
        if speed is None:
            return None
        return MovedEnd(inertia, speed, np.diff(speed, append=speed[-1]) / dt, None, jumps=False)
    slope = np.diff(angle) / dt
    slope = np.append(slope, slope[-1])
    if speed is None:
        return MovedEnd(inertia, slope, np.zeros(slope.size), float(angle[0]), jumps=True)
    change = np.diff(_of_length(angle, speed, drivetrain.locked), append=speed[-1])
    # The last sample's angle at its end is not given: there the speed is taken as it is.
    correction = np.append((slope - speed - 0.5 * change)[:-1], 0.0)
    worst = int(np.argmax(np.abs(correction)))
    if abs(correction[worst]) > _CONSISTENT * np.max(np.abs(speed)):
        raise InvalidInput(
            f"simulate: angle_{drivetrain.locked} and speed_{drivetrain.locked}",
            f"a slope of the angle of {slope[worst]:g} rad/s at a speed of {speed[worst]:g} rad/s in sample {worst}",
            "an angle whose slope is the speed",
            "Check units and time axes, or give one of the two.",
        )
    return MovedEnd(inertia, speed + correction, change / dt, float(angle[0]), jumps=True)


def _of_length(angle: Array, speed: Array, end: str) -> Array:
    """The speed, if it is as long as the angle."""
    if angle.size != speed.size:
        raise InvalidInput(
            "simulate",
            f"lengths {angle.size} of angle_{end} and {speed.size} of speed_{end}",
            "signals of one length",
            "Crop or extend them.",
        )
    return speed

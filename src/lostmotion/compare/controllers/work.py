"""What the drive is asked to do: set-points, load torque and start for each kind of work."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ... import signals

Array = NDArray[np.float64]

#: Speeds of the step (rad/s): that of Fietzek & Rinderknecht, Fig. 14 and 15.
STEP_FROM, STEP_TO = -2.0, 2.0
#: Time of the step, from which on all is judged, and end of the experiment, s (option).
STEP_TIME, END = 0.3, 0.9
#: Length of the pulse, s (option: longer than any law settles).
PULSE = 0.3
#: Torque step on the load, Nm (option: five times the Coulomb friction).
LOAD_STEP = -10.0
#: Creeping through zero: largest speed (rad/s) and its rate (rad/s²) (option).
CREEP_SPEED, CREEP_RATE = 0.4, 1.0
#: Hold at zero: judged from this time after the stop on, for so long, s (option).
SETTLED, REST = 0.5, 0.5
#: Tip-in: torque before and after (Nm), speed of the drive at the step (rad/s) (option).
TIP_FROM, TIP_TO, TIP_SPEED = -10.0, 20.0, 60.0


@dataclass(frozen=True, eq=False)
class Work:
    """Inputs of one experiment.

    Parameters
    ----------
    references : mapping of signal → (n,) array
        speed_reference (rad/s), or torque_reference (Nm) where a torque is asked for.
    torque_load : (n,) array, Nm, or None
    speed : float, rad/s
        Of the whole drivetrain at the start.
    start, stop : float, s
        What is judged.
    before, after : float
        Set-point before and after ``start``; equal where it has no step.
    """

    references: dict[str, Array]
    torque_load: Array | None
    speed: float
    start: float
    stop: float
    before: float
    after: float

    @property
    def asks_for_torque(self) -> bool:
        return "torque_reference" in self.references


def work(kind: str, dt: float, inertia: float) -> Work:
    """The work of a case; dt (s) of the plant, inertia (kg m²) of the whole drivetrain."""
    if kind in ("tip-in", "tip-out"):
        before, after = (TIP_FROM, TIP_TO) if kind == "tip-in" else (TIP_TO, TIP_FROM)
        torque = signals.steps((STEP_TIME,), (before, after), END, dt)
        start = TIP_SPEED - before / inertia * STEP_TIME
        return Work({"torque_reference": torque}, None, start, STEP_TIME, END, before, after)
    low, high, load = STEP_FROM, STEP_TO, None
    speed = signals.steps((STEP_TIME,), (low, high), END, dt)
    start, stop = STEP_TIME, END
    if kind == "pulse":
        start, low, high = STEP_TIME + PULSE, STEP_TO, STEP_FROM
        speed = signals.steps((STEP_TIME, start), (high, low, high), END, dt)
    elif kind == "load step":
        low, speed = high, np.full(speed.size, high)
        load = signals.steps((STEP_TIME,), (0.0, LOAD_STEP), END, dt)
    elif kind == "creep":
        low = high = CREEP_SPEED
        stop = STEP_TIME + 2.0 * CREEP_SPEED / CREEP_RATE
        time = dt * np.arange(round(stop / dt))
        speed = np.minimum(CREEP_RATE * np.maximum(time - STEP_TIME, 0.0) - CREEP_SPEED, CREEP_SPEED)
    elif kind == "rest":
        low, high, stop = STEP_TO, 0.0, STEP_TIME + SETTLED + REST
        speed = signals.steps((STEP_TIME,), (low, high), stop, dt)
    return Work({"speed_reference": speed}, load, 0.0, start, stop, low, high)

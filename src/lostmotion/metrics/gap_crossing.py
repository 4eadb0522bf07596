"""What a step of the set-point through the gap does to the drivetrain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..argument_checks import checks_arguments
from ..events import Events
from .arrays import pair
from .crossing_times import first_crossing
from .step_response import step_metrics

#: Time after the arrival over which the motor's oscillation is averaged, s (option: ten periods of 100 Hz).
OSCILLATION_TIME = 0.1


@dataclass(frozen=True)
class CrossingMetrics:
    """What a step of the set-point through the gap does to the drivetrain.

    Parameters
    ----------
    arrival_time : float or None, s
        From the step to the first crossing of 90 %: unlike the rise time it holds the crossing of the gap.
    motor_overshoot : float, rad/s
        Largest excursion of the motor speed beyond the new set-point; zero if there is none.
    motor_deviation : float or None, rad/s
        Largest distance of the motor speed from the new set-point, from the arrival on.
    oscillation, swing : float or None, rad/s
        RMS and largest size of motor speed − load speed over ``OSCILLATION_TIME`` from the arrival on.
    impacts : int
    impact_speed : float, rad/s
        Largest closing speed of an impact; zero without one.
    lash_time : float, s
        Time inside the gap.
    """

    arrival_time: float | None
    motor_overshoot: float
    motor_deviation: float | None
    oscillation: float | None
    swing: float | None
    impacts: int
    impact_speed: float
    lash_time: float


@checks_arguments
def crossing_metrics(
    time: ArrayLike,
    speed_motor: ArrayLike,
    speed_load: ArrayLike,
    events: Events,
    step_time: float,
    before: float,
    after: float,
    *,
    shaft: int = 1,
    stop_time: float = np.inf,
) -> CrossingMetrics:
    """Metrics of the crossing of the gap in shaft number ``shaft`` (from 1, from the motor on) after one step.

    Parameters
    ----------
    time : (n,) array, s
    speed_motor, speed_load : (n,) arrays, rad/s
    events : Events
        Of the simulated plant.
    step_time, stop_time : float, s
    before, after : float, rad/s
        Set-point before and after the step.

    Raises
    ------
    InvalidInput
        As ``step_metrics``.
    """
    motor = step_metrics(time, speed_motor, step_time, before, after, stop_time=stop_time)
    times, load = pair(time, speed_load)
    turning = pair(time, speed_motor)[1]
    slip = load - turning
    part = (times >= step_time) & (times < stop_time)
    arrival = first_crossing(times[part] - step_time, (load[part] - before) / (after - before), 0.9)
    oscillation = swing = deviation = None
    if arrival is not None:
        judged = (times >= step_time + arrival) & (times < step_time + arrival + OSCILLATION_TIME)
        oscillation, swing = float(np.sqrt(np.mean(slip[judged] ** 2))), float(np.max(np.abs(slip[judged])))
        later = part & (times >= step_time + arrival)
        deviation = float(np.max(np.abs(turning[later] - after)))
    events = Events.of(events)
    ours = events.only(
        np.array([place == f"shaft {shaft}" for place in events.places], dtype=bool)[events.place]
    )
    ours = ours.only((ours.time >= step_time) & (ours.time < stop_time))
    impacts = ours.of_kind("impact")
    return CrossingMetrics(
        arrival_time=arrival,
        motor_overshoot=motor.overshoot / 100.0 * abs(after - before),
        motor_deviation=deviation,
        oscillation=oscillation,
        swing=swing,
        impacts=len(impacts),
        impact_speed=float(np.max(np.abs(impacts.speed), initial=0.0)),
        lash_time=_time_apart(ours, step_time, min(stop_time, float(times[-1]))),
    )


def _time_apart(events: Events, start: float, stop: float) -> float:
    """Time between separations and the next impacts; what is open at an end counts up to it, no event as contact."""
    turns = [(e.time, e.kind) for e in events if e.kind in ("impact", "separation")]
    if not turns:
        return 0.0
    inside = [start] if turns[0][1] == "impact" else []
    inside += [t for t, _ in turns] + ([stop] if turns[-1][1] == "separation" else [])
    return float(np.sum(np.diff(inside)[::2]))

"""Score of one law in one experiment."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from ...metrics import crossing_metrics, recovery, step_metrics
from ...recording import Recording
from ...systems import connect
from ..scores import Score
from .contestants import Contestant
from .experiment import Experiment
from .work import SETTLED

Array = NDArray[np.float64]

#: Jerk of the load is taken over this time, s (option).
JERK_TIME = 1e-3
#: Band around the set-point after a load step, rad/s: 2 % of the step of the set-point (option).
BAND = 0.08
#: A loop is unstable if its error in the last fifth exceeds this share of the step, or 0.5 rad/s (option).
LOST, LOST_SPEED = 0.25, 0.5
#: Share of the run over which it is judged whether it settles (option).
LAST_PART = 0.2

#: Every number of a score, None where the work does not ask for it; s, rad/s, Nm, %, rad/s³.
METRICS = (
    "rise_time", "arrival_time", "overshoot", "settling_time", "steady_error", "peak_torque", "rms_torque",
    "motor_overshoot", "motor_deviation", "oscillation", "swing", "impacts", "impact_speed", "lash_time", "load_jerk",
    "recovery_error", "recovery_time", "tracking_error", "ripple", "rest_speed", "unstable", "refused", "time_per_step",
)  # fmt: skip


def score(found: Recording, data: Experiment) -> Score:
    """All numbers that the work asks for; see ``metrics`` for their definitions."""
    asked, result = data.work, dict.fromkeys(METRICS)
    rows = (found.time >= asked.start) & (found.time < asked.stop)
    speeds = [found[name] for name in ("speed_motor", "speed_load")]
    if not all(np.all(np.isfinite(signal)) for signal in (*speeds, found["torque_motor"])):
        return {**result, "unstable": 1.0}
    torque = found["torque_motor"][rows]
    scores: Score = {
        **result,
        "peak_torque": float(np.max(np.abs(torque))),
        "rms_torque": float(np.sqrt(np.mean(torque**2))),
        "load_jerk": _jerk(speeds[1][rows], found.dt),
        **_crossing(found, data),
    }
    if asked.asks_for_torque:
        return {**scores, **_tip(found, data)}
    error = found["speed_reference"] - speeds[1]
    last = error[rows][-max(1, round(LAST_PART * np.count_nonzero(rows))) :]
    allowed = max(LOST * abs(asked.after - asked.before), LOST_SPEED)
    scores["unstable"] = float(np.sqrt(np.mean(last**2)) > allowed)
    scores["tracking_error"] = float(np.sqrt(np.mean(error[rows] ** 2)))
    if asked.torque_load is not None:
        back = recovery(found.time, error, asked.start, BAND, asked.stop)
        scores |= {"recovery_error": back.largest_error, "recovery_time": back.time}
        scores["steady_error"] = abs(float(np.mean(last))) / abs(asked.after)
    elif asked.after == 0.0:
        resting = found.time >= asked.start + SETTLED
        scores["ripple"] = float(np.ptp(found["torque_motor"][resting]))
        scores["rest_speed"] = float(np.max(np.abs(speeds[1][resting])))
    return scores


def _crossing(found: Recording, data: Experiment) -> Score:
    asked, chain = data.work, data.plant.drivetrain
    joint = 1 + max(range(len(chain.shafts)), key=lambda i: chain.shafts[i].backlash)
    moves = asked.after != asked.before and not asked.asks_for_torque
    # Without a step of the speed only impacts and lash time mean something.
    levels = (asked.before, asked.after) if moves else (0.0, 1.0)
    crossing = crossing_metrics(
        found.time, found["speed_motor"], found["speed_load"], found.events, asked.start, *levels, shaft=joint,
        stop_time=asked.stop,
    )  # fmt: skip
    scores: Score = {
        "impacts": float(crossing.impacts),
        "impact_speed": crossing.impact_speed,
        "lash_time": crossing.lash_time,
    }
    if moves:
        step = step_metrics(
            found.time, found["speed_load"], asked.start, asked.before, asked.after, stop_time=asked.stop
        )
        scores |= {
            "rise_time": step.rise_time,
            "overshoot": step.overshoot,
            "settling_time": step.settling_time,
            "steady_error": step.steady_error,
            "arrival_time": crossing.arrival_time,
            "motor_overshoot": crossing.motor_overshoot,
            "motor_deviation": crossing.motor_deviation,
            "oscillation": crossing.oscillation,
            "swing": crossing.swing,
        }
    return scores


def _tip(found: Recording, data: Experiment) -> Score:
    """Of a tip-in or tip-out: arrival and overshoot are those of the load's acceleration over ``JERK_TIME``."""
    asked, n = data.work, max(1, round(JERK_TIME / found.dt))
    speed = found["speed_load"]
    acceleration = (speed[n:] - speed[:-n]) / (n * found.dt)
    inertia = data.plant.drivetrain.inertia_total
    friction = data.plant.drivetrain.frictions[-1].torque(float(speed[round(asked.start / found.dt)]))
    before, after = ((torque - friction) / inertia for torque in (asked.before, asked.after))
    step = step_metrics(found.time[n:], acceleration, asked.start, before, after, stop_time=asked.stop)
    reached = np.flatnonzero(
        (found.time[n:] >= asked.start) & ((acceleration - before) / (after - before) >= 0.9)
    )
    arrival = None if reached.size == 0 else float(found.time[n:][reached[0]] - asked.start)
    settles = step.steady_error < LOST
    return {"arrival_time": arrival, "overshoot": step.overshoot, "unstable": float(not settles)}


def _jerk(speed: Array, dt: float) -> float:
    """Largest change of the load's acceleration over ``JERK_TIME``, each acceleration a mean over it; rad/s³."""
    n = max(1, round(JERK_TIME / dt))
    span = n * dt
    second = speed[2 * n :] - 2.0 * speed[n:-n] + speed[: -2 * n]
    return float(np.max(np.abs(second))) / span**2 if second.size else 0.0


def time_per_step(contestant: Contestant, data: Experiment, steps: int = 2000) -> float | None:
    """Processor time of one step of all laws together, s; None where they cannot be joined to one law."""
    laws = list(contestant.control(data.setting))
    if contestant.observer is not None:
        laws.insert(0, contestant.observer(data.setting).renamed({"torque_motor": "torque_motor_acting"}))
    made = {name for law in laws for name in law.outputs}
    inputs = tuple(dict.fromkeys(name for law in laws for name in law.inputs if name not in made))
    if not all(hasattr(law, "curves") for law in laws):
        return None
    joined = connect(laws, inputs=inputs, outputs=("torque_motor",))  # type: ignore[arg-type]
    signals = {name: np.zeros(steps) for name in inputs}
    joined.run(signals)
    spent = []
    for _ in range(3):
        before = time.process_time()
        joined.run(signals)
        spent.append((time.process_time() - before) / steps)
    return min(spent)

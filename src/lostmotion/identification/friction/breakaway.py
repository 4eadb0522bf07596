"""Breakaway level: the torque at which a slow ramp starts the motion."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...argument_checks import checks_arguments, not_negative
from ...recording import Recording
from ..statistics.estimates import Estimates, Interval
from . import problems as problem
from .result import Floats, torque_to_use


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Breakaway(Estimates):
    """Levels at which ramps of torque started the motion.

    Values: ``breakaway_plus``, ``breakaway_minus``, Nm, both positive; None where no ramp in that direction started a
    motion. Intervals: scatter of the ramps (Student t) and what the instant of the start leaves open.

    Attributes
    ----------
    starts : (m, 3) array
        Time (s), torque (Nm) and, in Nm, how much of it the instant of the start leaves open.
    at_rest : float, Nm
        Largest torque (absolute) under which the drive rested, where it never moved; else NaN.
    time, torque, angle : (n,) arrays
        s, Nm, rad; for plots.
    """

    starts: Floats
    at_rest: float
    time: Floats
    torque: Floats
    angle: Floats


#: Speeds are means over this long, s (calibrated on the virtual rigs 1 to 4, whose eigenmode it averages over five
#: periods: half and double give the same level, 0.6 % off at most; benchmarks/calibrations.py).
SMOOTHING = 0.05
#: The drive moves from this part of the largest speed on (calibrated on the same: half gives the
#: same, double 1.6 % instead of 0.6 %).
MOVING = 0.01
#: Time at rest before a start, to which the reference line of the angle is fitted, s (option).
REST = 0.4
#: Largest delay of a start in the signals, s: the torque follows its set-point, and a load's start shows through the
#: shaft (calibrated on the same, where half and double give the same level; there it is 2 ms: the current loop and a
#: quarter period of the 100 Hz eigenmode).
LATE = 3e-3
#: The angle has departed from that line at this many standard deviations of its scatter (numerics: by chance one sample
#: in 500 million has).
DEPARTURE = 6.0


@checks_arguments
def breakaway(
    recording: Recording, *, angle: str = "angle_motor", torque: str | None = None, travel: float = 0.1
) -> Breakaway:
    """Torque at which slow ramps start the motion, for each direction.

    Before a start the angle follows a line (rest, or the wind-up of a shaft behind which the load still rests). From
    the instants t₁ and t₂ at which it has departed from that line by d and by 4d the start is 2t₁ − t₂ if the
    acceleration jumps (friction falls at once), by d and by 8d if it grows with the ramp. The first is quoted; how
    far it lies from the second, or from t₁, counts as unknown, and so does what the ramp gains in ``LATE``. Ramps must
    be slow: what an interval leaves open is ramp rate times the time that the departure takes.

    Parameters
    ----------
    recording : Recording
        One or more ramps from rest, in one direction or both.
    angle, torque : str
        ``angle_load`` where the friction sits at the load and is measured; the torque's default is the measured one
        where there is one.
    travel : float, rad
        A motion counts from this far on: more than a gap and the wind-up let the motor turn (default chosen).
    """
    not_negative("breakaway.travel", travel, positive=True)
    used, problems = torque_to_use(recording, torque)
    theta, m = recording[angle], recording[used]
    rows = [_start(theta, m, i, recording.dt) for i in _first_moves(theta, recording.dt, travel)]
    found = np.array([(recording.time[round(k)], t, o, s) for k, t, o, s in filter(None, rows)]).reshape(
        -1, 4
    )
    values: dict[str, float | None] = {}
    intervals: dict[str, Interval] = {}
    for name, side in (("breakaway_plus", 1.0), ("breakaway_minus", -1.0)):
        mine = found[found[:, 3] == side]
        values[name] = None
        if len(mine):
            level, margin = _level(side * mine[:, 1], mine[:, 2])
            values[name], intervals[name] = level, (level - margin, level + margin)
            if len(mine) == 1:
                problems += (problem.one_ramp(name),)
    at_rest = math.nan
    if not len(found):
        at_rest = float(np.abs(m).max())
        problems += (problem.never_moved(angle, at_rest, REST),)
    return Breakaway(
        values=values,
        intervals=intervals,
        problems=problems,
        starts=found[:, :3],
        at_rest=at_rest,
        time=recording.time,
        torque=m,
        angle=theta,
    )


def _first_moves(theta: Floats, dt: float, travel: float) -> list[int]:
    """Rows where the drive begins to move, after resting, and goes on for the travel asked for."""
    from scipy.ndimage import binary_closing

    width = max(round(SMOOTHING / dt), 1)
    speed = np.abs(theta[width:] - theta[:-width])
    slowest = float(np.median(np.abs(np.diff(theta, 2)))) + 4.0 * _count(theta)
    # Closed gaps: near the threshold, counts make it flicker.
    moves = binary_closing(speed > max(MOVING * float(speed.max()), slowest), np.ones(width, dtype=bool))
    rest = round(REST / dt)
    first = np.flatnonzero(moves[1:] & ~moves[:-1]) + 1
    last = np.append(np.flatnonzero(moves[:-1] & ~moves[1:]) + 1, theta.size - 1)
    ends = last[np.searchsorted(last, first)]
    return [
        int(i)
        for i, end in zip(first, ends, strict=True)
        if i >= rest and not moves[i - rest : i].any() and abs(theta[end] - theta[i]) >= travel
    ]


def _count(theta: Floats) -> float:
    """Step of the encoder: the smallest change between samples."""
    steps = np.abs(np.diff(theta))
    steps = steps[steps > 0.0]
    return float(steps.min()) if steps.size else 0.0


def _start(theta: Floats, m: Floats, i: int, dt: float) -> tuple[float, float, float, float] | None:
    """Row, torque, what is open of it, direction of the start near row i; None where the torque did not drive it."""
    rest, width = round(REST / dt), max(round(SMOOTHING / dt), 1)
    # The first creep is slower than what counts as moving: the line ends well before.
    before = np.arange(max(i - rest - rest // 2, 0), i - rest // 2)
    line = np.polyfit(before, theta[before], 1)
    scatter = float(np.std(theta[before] - np.polyval(line, before)))
    after = np.arange(i - rest // 2, min(i + 20 * width, theta.size))
    departed = theta[after] - np.polyval(line, after)
    side = math.copysign(1.0, departed[np.argmax(np.abs(departed))])
    d = max(DEPARTURE * scatter, _count(theta), 1e-9 * float(np.abs(departed).max()))
    over = [np.flatnonzero(side * departed > level) for level in (d, 4.0 * d, 8.0 * d)]
    pushed = side * (m[before[-1]] - m[before[0]]) > 0.0 and side * m[i] > 0.0
    if not (over[2].size and pushed):
        return None
    t1, t2, t3 = (float(after[rows[0]]) for rows in over)
    starts = np.maximum([t1, 2.0 * t1 - t2, 2.0 * t1 - t3], float(before[0]))
    torques = np.interp(starts, np.arange(m.size), m)
    rate = abs(float(np.polyfit(before * dt, m[before], 1)[0]))
    open_ = float(np.abs(torques - torques[1]).max()) + LATE * rate
    return float(starts[1]), float(torques[1]), open_, side


def _level(levels: Floats, open_: Floats) -> tuple[float, float]:
    from scipy.stats import t as student

    n, margin = levels.size, float(open_.mean())
    if n > 1:
        margin += float(student.ppf(0.975, n - 1)) * float(levels.std(ddof=1)) / math.sqrt(n)
    return float(levels.mean()), margin

"""Lost motion from motor and load angle, both measured: their delay first, then wind-up, hysteresis, dead zone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments, not_negative
from ...errors import InvalidInput, Problem
from ...recording import Recording
from ..friction.result import Floats, torque_to_use
from ..statistics.estimates import Estimates, Interval
from ..statistics.regression import LinearFit, linear_fit
from . import problems as problem

# Calibrated on two masses with a gap of 3 mrad and 16 bit, seeds 1 to 4: with half or double of any of the three the
# largest error of the backlash is 0.05 to 0.3 % (benchmarks/calibrations.py).

#: Cut-off of the smoothed speed and torque over the sample rate (calibrated, as all three).
CUTOFF = 0.1
#: Speeds below this part of the largest have no sure direction and are left out (calibrated, as all).
TURNING = 0.02
#: Torques below this part of the largest may lie inside a gap: they have no sure flank (calibrated, as all).
IN_CONTACT = 0.1
#: Rows further than this many standard deviations (by their median) from the fit bounce and are left out; so often.
#: (Numerics: of normal errors 0.3 % are.)
TRIM, TRIMS = 3.0, 5
#: A gap within this many standard deviations of the twist about the fit is not reported (numerics: the two
#: flanks are then two deviations on either side of what lies between).
CLAIM = 4.0
#: Resolution of the delay as part of a sample (option: clocks jitter, and no interval is narrower).
FINEST_DELAY = 1e-3
#: Fits: without a shift, and with the load's angle shifted by the delay found (numerics).
PASSES = 2
#: Reversals of the torque from which on a dead zone is looked for (option).
MIN_REVERSALS = 4
#: Fewest samples (numerics: ten for each of the blocks that the intervals come from).
MIN_ROWS = 200
#: What is looked for.
VALUES = ("delay", "compliance", "hysteresis", "backlash")


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LostMotion(Estimates):
    """What lies between two measured angles::

        motor − load = offset + delay·speed + compliance·torque + hysteresis/2·sgn(speed) + backlash/2·sgn(torque)

    Values: ``delay`` (s, positive: the load's angle is late), ``compliance`` (rad/Nm), ``hysteresis`` (rad, full width,
    always positive), ``backlash`` (rad, total). A backlash is reported only if its interval excludes zero and the jump
    exceeds the scatter. Otherwise its interval is still given: the upper end is the largest backlash that may exist.

    Attributes
    ----------
    torque_signal : str or None
        The torque used; None: there is none.
    time, torque, twist, fitted : (n,) arrays
        s, Nm, and rad with delay and offset taken off; ``fitted`` is NaN where the drive hardly turns.
    direction : (n,) array
        sgn(speed), 0 where the drive hardly turns.
    """

    torque_signal: str | None
    time: Floats
    torque: Floats
    twist: Floats
    fitted: Floats
    direction: Floats


@checks_arguments
def lost_motion(
    recording: Recording,
    *,
    angle_motor: str = "angle_motor",
    angle_load: str = "angle_load",
    torque: str | None = None,
    inertia_motor: float = 0.0,
) -> LostMotion:
    """Separate delay, wind-up, hysteresis and dead zone by what each follows: speed, torque, and their signs.

    An encoder that is late by a millisecond shows speed · 1 ms of twist that does not exist, usually the largest part
    by far. The delay is estimated first, together with everything it could be mistaken for; then the load's angle is
    shifted by it and the rest is fitted. Friction between the encoders makes a hysteresis that reverses with the
    direction of motion, whatever the torque; a gap jumps where the **torque** reverses. Without a torque, or without
    its reversal, the two cannot be separated and no dead zone is reported; nor where it may as well be a stiffness
    that rises with the torque (a term torque·abs(torque) is tried beside it).

    Parameters
    ----------
    recording : Recording
        Both angles in rad at the same side of a gear.
    angle_motor, angle_load : str
    torque : str, optional
        Default: ``torque_shaft``, else the motor torque.
    inertia_motor : float, kg m2
        With a motor torque: the inertia before the shaft. Friction there shows as hysteresis.

    Returns
    -------
    LostMotion
        Intervals: jackknife over 20 blocks.
    """
    if len(recording) < MIN_ROWS:
        raise InvalidInput(
            "lost_motion", f"{len(recording)} samples", f"at least {MIN_ROWS}", "Record longer."
        )
    not_negative("lost_motion.inertia_motor", inertia_motor)
    dt = recording.dt
    name, problems = _torque(recording, torque)
    m = np.zeros(len(recording)) if name is None else _smooth(recording[name])
    if name is not None and name != "torque_shaft" and inertia_motor:
        m = m - inertia_motor * _smooth(np.gradient(np.gradient(recording[angle_motor], dt), dt))
    apparent, columns, rows, fit = _without_delay(
        recording, recording[angle_motor], recording[angle_load], None if name is None else m
    )
    values, intervals = _identified(tuple(columns), fit)
    problems += () if name is not None else (problem.no_torque(),)
    if name is not None:
        reversals = _reversals(m)
        if reversals < MIN_REVERSALS:
            problems += (problem.hardly_reverses(name, m, reversals, MIN_REVERSALS),)
        else:
            columns, fit, found = _dead_zone(columns, apparent, m, rows, fit)
            intervals["backlash"] = found
            if found[0] > 0.0:
                values, more = _identified(tuple(columns), fit)
                intervals = {**more, "backlash": found}
            else:
                problems += (problem.none_reported(found, CLAIM),)
    delay, (low, high) = float(values["delay"] or 0.0), intervals["delay"]
    finest = FINEST_DELAY * dt
    intervals["delay"] = (min(low, delay - finest), max(high, delay + finest))
    parts = {n: value * columns[n] for n, value in zip(columns, fit.values.tolist(), strict=True)}
    aligned = parts["offset"] + parts["delay"]
    model = np.sum(list(parts.values()), axis=0)
    values["hysteresis"], intervals["hysteresis"] = _width(values["hysteresis"], intervals["hysteresis"])
    values = {n: values.get(n) for n in VALUES}
    return LostMotion(
        values=values,
        intervals=intervals,
        problems=problems,
        torque_signal=name,
        time=recording.time,
        torque=m,
        twist=apparent - aligned,
        fitted=np.where(rows, model - aligned, np.nan),
        direction=2.0 * columns["hysteresis"],
    )


def _without_delay(
    recording: Recording, angle_motor: Floats, angle_load: Floats, torque: Floats | None
) -> tuple[Floats, dict[str, Floats], NDArray[np.bool_], LinearFit]:
    """Twist with the load's angle shifted by the delay, what it may consist of, the rows that tell it, and its fit.

    The delay is fitted together with all that it could be mistaken for, in a few passes. Arrays (n,).
    """
    time, dt, shift = recording.time, recording.dt, 0.0
    for _ in range(PASSES):
        load = _earlier(time, angle_load, shift)
        speed = _smooth(np.gradient(load, dt))
        # The first order in the delay that is left: speed·delay.
        apparent = angle_motor - load + shift * speed
        way = np.sign(speed) * (np.abs(speed) > TURNING * float(np.abs(speed).max()))
        columns = {"offset": np.ones_like(speed), "delay": speed, "hysteresis": 0.5 * way}
        if torque is not None:
            columns["compliance"] = torque
        rows = way != 0.0
        # What the shift has no samples for at the ends.
        rows[:: len(rows) - 1] = False
        rows &= np.abs(time - time.mean()) < 0.5 * dt * len(rows) - abs(shift)
        fit = _fit(columns, apparent, rows)
        shift = float(fit.values[1])
    return apparent, columns, rows, fit


def _earlier(time: Floats, values: Floats, shift: float) -> Floats:
    """values(time + shift), by cubic splines; the last value beyond the ends."""
    if shift == 0.0:
        return np.array(values)
    from scipy.interpolate import CubicSpline

    at = np.clip(time + shift, time[0], time[-1])
    return np.asarray(CubicSpline(time, values)(at), dtype=float)


def _smooth(values: Floats) -> Floats:
    from scipy.signal import butter, filtfilt

    b, a = butter(4, 2.0 * CUTOFF)
    return np.asarray(filtfilt(b, a, values), dtype=float)


def _torque(recording: Recording, torque: str | None) -> tuple[str | None, tuple[Problem, ...]]:
    if torque is None and "torque_shaft" in recording:
        return "torque_shaft", ()
    if torque is None and not any(n.startswith("torque_motor") for n in recording):
        return None, ()
    return torque_to_use(recording, torque)


def _fit(columns: Mapping[str, Floats], y: Floats, rows: NDArray[np.bool_]) -> LinearFit:
    return linear_fit(np.stack([c[rows] for c in columns.values()]), y[rows])


def _identified(
    names: tuple[str, ...], fit: LinearFit
) -> tuple[dict[str, float | None], dict[str, Interval]]:
    found = [
        (n, float(v), float(m))
        for n, v, m in zip(names, fit.values, fit.margins, strict=True)
        if n != "offset"
    ]
    return {n: v for n, v, _ in found}, {n: (v - m, v + m) for n, v, m in found}


def _reversals(m: Floats) -> int:
    sides = np.sign(m) * (np.abs(m) > IN_CONTACT * float(np.abs(m).max()))
    return int(np.count_nonzero(np.diff(sides[sides != 0.0])))


def _dead_zone(
    columns: Mapping[str, Floats], y: Floats, m: Floats, rows: NDArray[np.bool_], without: LinearFit
) -> tuple[dict[str, Floats], LinearFit, Interval]:
    """The columns and fit to be used, and the interval of the backlash, from fits with and without rising stiffness."""
    gap = {**columns, "backlash": 0.5 * np.sign(m)}
    sure = rows & (np.abs(m) > IN_CONTACT * float(np.abs(m).max()))
    fit = _fit(gap, y, sure)
    for _ in range(TRIMS):
        # While it bounces, there is torque already while the twist is still inside the gap: outliers to one side.
        values = fit.values @ np.stack(list(gap.values()))
        error = np.abs(y - values)
        sure &= error < TRIM * 1.4826 * float(np.median(error[sure]))
        fit = _fit(gap, y, sure)
    bent = _fit({**gap, "rising": m * np.abs(m)}, y, sure)
    i = list(gap).index("backlash")
    change = abs(float(bent.values[i] - fit.values[i]))
    scatter = 1.4826 * float(np.median(np.abs(fit.residual)))
    # Bounces that were not left out lie to one side, within the scatter: half of it is allowed for (chosen).
    margin = float(np.linalg.norm([fit.margins[i], change, 0.5 * scatter]))
    low, high = float(fit.values[i]) - margin, float(fit.values[i]) + margin
    if low > 0.0 and fit.values[i] > CLAIM * scatter and bent.values[i] > bent.margins[i]:
        return gap, fit, (low, high)
    return dict(columns), without, (min(low, 0.0), high)


def _width(value: float | None, interval: Interval) -> tuple[float | None, Interval]:
    """A hysteresis against the motor's torque may have either sign: its width is what is asked for."""
    low, high = sorted(abs(end) for end in interval)
    if interval[0] <= 0.0 <= interval[1]:
        low = 0.0
    return (None if value is None else abs(value)), (low, high)

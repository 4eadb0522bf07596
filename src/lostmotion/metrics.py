"""Metrics: errors of an estimate, and quality of the response to a step of the set-point.

Pure functions on arrays. A value that is not defined for the given data is ``None``, never NaN.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .argument_checks import checks_arguments, not_negative
from .errors import InvalidInput
from .events import Events

Array = NDArray[np.float64]

#: Largest lag in the search, s (option: ten periods of an eigenfrequency of 200 Hz).
MAX_LAG = 0.05
#: Last part of the time after the step over which the steady error is averaged (option).
STEADY_PART = 0.2
#: Band around the new set-point for the settling time, as a fraction of the step (option).
SETTLING_BAND = 0.02
#: Time after the arrival over which the motor's oscillation is averaged, s (option: ten periods of 100 Hz).
OSCILLATION_TIME = 0.1


def _finite(where: str, values: ArrayLike) -> Array:
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or array.size == 0 or not np.all(np.isfinite(array)):
        raise InvalidInput(
            f"metrics: {where}",
            f"shape {array.shape}, {np.count_nonzero(~np.isfinite(array))} values not finite",
            "a one-dimensional array of finite numbers",
            "Drop or replace NaN and infinity first.",
        )
    return array


def _pair(a: ArrayLike, b: ArrayLike) -> tuple[Array, Array]:
    first, second = _finite("first array", a), _finite("second array", b)
    if first.shape != second.shape:
        raise InvalidInput(
            "metrics",
            f"{first.size} and {second.size} values",
            "two equally long arrays",
            "Bring both to one time axis.",
        )
    return first, second


@checks_arguments
def rmse(a: ArrayLike, b: ArrayLike) -> float:
    """Root of the mean squared difference of two (n,) arrays, in their unit."""
    first, second = _pair(a, b)
    return float(np.sqrt(np.mean((first - second) ** 2)))


@checks_arguments
def largest_error(a: ArrayLike, b: ArrayLike) -> float:
    """Largest absolute difference of two (n,) arrays, in their unit."""
    first, second = _pair(a, b)
    return float(np.max(np.abs(first - second)))


@checks_arguments
def signal_range(a: ArrayLike) -> float:
    """Largest minus smallest value of an (n,) array, in its unit."""
    return float(np.ptp(_finite("array", a)))


@checks_arguments
def lag(estimate: ArrayLike, truth: ArrayLike, dt: float, max_lag: float = MAX_LAG) -> float | None:
    """Time (s) by which the estimate is late; negative if it is early.

    The shift that minimises the variance of ``estimate(t) − truth(t − shift)`` over a fixed window of the
    estimate, searched over whole samples and refined by the parabola through the smallest value and its two
    neighbours. A constant offset changes nothing, and independent noise does not bias it: its variance is the
    same at every shift.

    Parameters
    ----------
    estimate, truth : (n,) arrays in the same unit
    dt : float, s
        Sample time.
    max_lag : float, s
        Largest shift that is tried; at most a quarter of the signals' length.

    Returns
    -------
    float or None
        ``None`` where no lag is defined: either signal is constant, there are fewer than eight samples, or
        the variance has no minimum within ±max_lag.
    """
    late, early = _pair(estimate, truth)
    not_negative("lag.max_lag", max_lag)
    reach = int(min(np.ceil(max_lag / not_negative("lag.dt", dt, positive=True)), late.size // 4))
    if reach < 2 or np.ptp(late) == 0.0 or np.ptp(early) == 0.0:
        return None
    variance = _difference_variance(late - late.mean(), early - early.mean(), reach)
    best = int(np.argmin(variance))
    if best in (0, variance.size - 1):
        return None
    left, middle, right = variance[best - 1 : best + 2]
    curvature = left - 2.0 * middle + right
    offset = 0.5 * (left - right) / curvature if curvature > 0.0 else 0.0
    return float((best - reach + offset) * dt)


def _difference_variance(late: Array, early: Array, reach: int) -> Array:
    """Variance of late[k] − early[k − shift] over the inner samples k, for shift = −reach … reach."""
    inner = late[reach : late.size - reach]
    count = inner.size
    # Sum of inner[k]·early[k + i], i = 2·reach − (shift + reach), by FFT: a tenth of the time of sums.
    from scipy.fft import irfft, next_fast_len, rfft

    length = next_fast_len(early.size, real=True)
    product = irfft(rfft(early, length) * np.conj(rfft(inner, length)), length)[2 * reach :: -1]
    total = _moving_sum(early, count)[::-1]
    square = _moving_sum(early**2, count)[::-1]
    variance_early = square / count - (total / count) ** 2
    covariance = product / count - inner.mean() * total / count
    return np.asarray(inner.var() + variance_early - 2.0 * covariance)


def _moving_sum(values: Array, count: int) -> Array:
    running = np.concatenate(([0.0], np.cumsum(values)))
    return np.asarray(running[count:] - running[:-count])


@checks_arguments
def compare(estimate: ArrayLike, truth: ArrayLike, dt: float) -> dict[str, float | None]:
    """Metrics of an estimate against the truth, as in ``results.json``.

    Returns
    -------
    dict
        ``rmse``, ``range`` (of the truth) and ``max`` (largest error) in the signals' unit, ``lag`` in s (see
        `lag`), ``rmse_of_range`` as a fraction (``None`` if the truth is constant).
    """
    error, span = rmse(estimate, truth), signal_range(truth)
    return {
        "rmse": error,
        "range": span,
        "max": largest_error(estimate, truth),
        "lag": lag(estimate, truth, dt),
        "rmse_of_range": error / span if span > 0.0 else None,
    }


@dataclass(frozen=True)
class StepMetrics:
    """Response to a step of the set-point.

    Parameters
    ----------
    overshoot : float, % of the step
        Largest excursion beyond the new set-point; zero if there is none.
    rise_time : float or None, s
        From the first crossing of 10 % to the first crossing of 90 % of the step.
    settling_time : float or None, s
        From the step to the last entry into ±2 % of the step around the new set-point; ``None`` if the signal
        ends outside.
    peak_torque : float or None, Nm
        Largest absolute torque from the step on; ``None`` without a torque.
    steady_error : float, fraction of the step
        |mean over the last fifth of the time after the step − new set-point|.
    """

    overshoot: float
    rise_time: float | None
    settling_time: float | None
    peak_torque: float | None
    steady_error: float

    def as_dict(self) -> dict[str, float | None]:
        return asdict(self)


@checks_arguments
def step_metrics(
    time: ArrayLike,
    signal: ArrayLike,
    step_time: float,
    before: float,
    after: float,
    torque: ArrayLike | None = None,
    stop_time: float = np.inf,
) -> StepMetrics:
    """Metrics of the response of a signal to one step of its set-point.

    Crossings are interpolated linearly between samples.

    Parameters
    ----------
    time : (n,) array, s
    signal : (n,) array
        The response, such as the load speed in rad/s.
    step_time : float, s
        Time of the step.
    before, after : float
        Set-point before and after the step, in the signal's unit.
    torque : (n,) array, optional, Nm
        Motor torque, for ``peak_torque``.
    stop_time : float, s
        End of the judged part, for a pulse: the time of the step back.

    Raises
    ------
    InvalidInput
        If the set-points are equal, lengths differ, a value is not finite, or fewer than five samples follow
        the step.
    """
    times, response = _pair(time, signal)
    if before == after:
        raise InvalidInput(
            "step_metrics", f"a step from {before} to {after}", "two different set-points", "Choose a step."
        )
    part = (times >= step_time) & (times < stop_time)
    if np.count_nonzero(part) < 5:
        raise InvalidInput(
            "step_metrics.step_time",
            f"{np.count_nonzero(part)} samples from {step_time} to {stop_time} s",
            f"at least five samples between {times[0]:g} and {times[-1]:g} s",
            "Check the time of the step.",
        )
    elapsed = times[part] - step_time
    progress = (response[part] - before) / (after - before)
    start, end = _first_crossing(elapsed, progress, 0.1), _first_crossing(elapsed, progress, 0.9)
    return StepMetrics(
        overshoot=max(0.0, 100.0 * (float(np.max(progress)) - 1.0)),
        rise_time=None if start is None or end is None else end - start,
        settling_time=_settling_time(elapsed, np.abs(progress - 1.0)),
        peak_torque=None if torque is None else float(np.max(np.abs(_pair(times, torque)[1][part]))),
        steady_error=abs(float(np.mean(progress[elapsed >= elapsed[-1] * (1.0 - STEADY_PART)])) - 1.0),
    )


def _first_crossing(elapsed: Array, progress: Array, level: float) -> float | None:
    """First time at which progress reaches the level, ``None`` if never."""
    reached = np.flatnonzero(progress >= level)
    if reached.size == 0:
        return None
    i = int(reached[0])
    return float(elapsed[0]) if i == 0 else _interpolate(elapsed, progress, i - 1, level)


def _settling_time(elapsed: Array, distance: Array, band: float = SETTLING_BAND) -> float | None:
    """Last entry into the band; zero if the signal never leaves it, ``None`` if it ends outside."""
    outside = np.flatnonzero(distance > band)
    if outside.size == 0:
        return 0.0
    i = int(outside[-1])
    return None if i == distance.size - 1 else _interpolate(elapsed, distance, i, band)


def _interpolate(elapsed: Array, values: Array, i: int, level: float) -> float:
    """Time at which the straight line from sample i to i + 1 meets the level."""
    share = (level - values[i]) / (values[i + 1] - values[i])
    return float(elapsed[i] + share * (elapsed[i + 1] - elapsed[i]))


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
    times, load = _pair(time, speed_load)
    turning = _pair(time, speed_motor)[1]
    slip = load - turning
    part = (times >= step_time) & (times < stop_time)
    arrival = _first_crossing(times[part] - step_time, (load[part] - before) / (after - before), 0.9)
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


@dataclass(frozen=True)
class Recovery:
    """How a disturbance was rejected: largest error (signal's unit) and time (s) from which on it stays in the band.

    ``time`` is ``None`` where the signal ends outside the band.
    """

    largest_error: float
    time: float | None


@checks_arguments
def recovery(
    time: ArrayLike, error: ArrayLike, start: float, band: float, stop_time: float = np.inf
) -> Recovery:
    """How an error (n,) goes back into ±band after a disturbance at ``start`` (s)."""
    times, errors = _pair(time, error)
    part = (times >= start) & (times < stop_time)
    if not band > 0.0 or np.count_nonzero(part) < 5:
        raise InvalidInput(
            "recovery", f"band {band}, {np.count_nonzero(part)} samples", "a positive band, five samples or more",
            "Check band and times.",
        )  # fmt: skip
    size = np.abs(errors[part])
    return Recovery(float(np.max(size)), _settling_time(times[part] - start, size, band))

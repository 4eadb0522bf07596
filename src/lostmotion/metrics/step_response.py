"""Quality of the response to a step of the set-point, and to a disturbance."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .arrays import pair
from .crossing_times import first_crossing, settling_time

#: Last part of the time after the step over which the steady error is averaged (option).
STEADY_PART = 0.2


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
    times, response = pair(time, signal)
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
    start, end = first_crossing(elapsed, progress, 0.1), first_crossing(elapsed, progress, 0.9)
    return StepMetrics(
        overshoot=max(0.0, 100.0 * (float(np.max(progress)) - 1.0)),
        rise_time=None if start is None or end is None else end - start,
        settling_time=settling_time(elapsed, np.abs(progress - 1.0)),
        peak_torque=None if torque is None else float(np.max(np.abs(pair(times, torque)[1][part]))),
        steady_error=abs(float(np.mean(progress[elapsed >= elapsed[-1] * (1.0 - STEADY_PART)])) - 1.0),
    )


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
    times, errors = pair(time, error)
    part = (times >= start) & (times < stop_time)
    if not band > 0.0 or np.count_nonzero(part) < 5:
        raise InvalidInput(
            "recovery", f"band {band}, {np.count_nonzero(part)} samples", "a positive band, five samples or more",
            "Check band and times.",
        )  # fmt: skip
    size = np.abs(errors[part])
    return Recovery(float(np.max(size)), settling_time(times[part] - start, size, band))

"""The part of a recording inside its window, on a raster of equal steps; all problems that forbid it together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputProblems, InvalidInput, Problem
from ...memory import check_memory
from ..tables.units import parse_quantity
from .checks import (
    MINIMUM_SAMPLES,
    check_finite,
    check_increasing,
    check_length,
    check_raster,
    check_sample_time,
    stop_at_errors,
)
from .raw_signals import RawSignals
from .signal_faults import check_sizes

#: Memory that a number of a new raster takes: as it is made, and in the recording (numerics: three doubles).
_BYTES = 24.0


def checked(
    raw: RawSignals, where: str, window: tuple[float, float] | None, resample: str | float | bool | None
) -> RawSignals:
    """The part inside the window, on a raster, or all problems that forbid it."""
    problems = check_finite("time", raw.time, where, raw.place) or check_increasing(
        raw.time, where, raw.place
    )
    if problems:
        # A window is no range of rows then; what lies in it by its own times is still checked.
        inside = _inside(raw.time, window, where)
        for name, values in raw.signals.items():
            problems += check_finite(name, np.where(inside, values, 0.0), where, raw.place)
        raise InputProblems(problems)
    rows = _rows(raw.time, window, where)
    time = raw.time[rows]

    def place(row: int) -> str:
        return raw.place(row + rows.start)

    problems = check_length(time.size, where) or check_sample_time(time, where)
    for name, values in raw.signals.items():
        problems += check_finite(name, values[rows], where, place)
        problems += check_sizes(name, values[rows], where, place)
    warnings: list[Problem] = []
    if resample is None or resample is False:
        problems += check_raster(time, where, place) if time.size > 2 else []
    stop_at_errors(problems)
    part = replace(
        raw, time=time, signals={name: values[rows] for name, values in raw.signals.items()}, place=place
    )
    if resample is not None and resample is not False:
        part, warnings = _resampled(part, where, resample)
    return replace(part, warnings=(*raw.warnings, *warnings))


def _inside(time: NDArray[np.float64], window: tuple[float, float] | None, where: str) -> NDArray[np.bool_]:
    """Rows whose time lies in the window, whatever their order."""
    if window is None:
        return np.ones(time.size, dtype=bool)
    start, stop = (parse_quantity(edge, "s", f"{where}, window") for edge in window)
    return (time >= start) & (time < stop)


def _rows(time: NDArray[np.float64], window: tuple[float, float] | None, where: str) -> slice:
    if window is None:
        return slice(0, time.size)
    start, stop = (parse_quantity(edge, "s", f"{where}, window") for edge in window)
    slack = 1e-6 * float(np.median(np.diff(time)))
    first, last = np.searchsorted(time, (start - slack, stop - slack))
    if not stop > start or last - first < 2:
        raise InvalidInput(
            f"{where}, window",
            f"[{start:g}, {stop:g}) s",
            f"start < stop between {time[0]:g} and {time[-1]:g} s",
            "Choose a window inside the recording.",
        )
    return slice(int(first), int(last))


def _resampled(raw: RawSignals, where: str, resample: str | float | bool) -> tuple[RawSignals, list[Problem]]:
    """Linear interpolation to equal steps, and the warning that says so."""
    steps = np.diff(raw.time)
    old = float(np.median(steps))
    step = old if resample is True else parse_quantity(resample, "s", f"{where}, resample")
    if step <= 0.0 or (raw.time[-1] - raw.time[0]) / step < MINIMUM_SAMPLES - 1:
        raise InvalidInput(
            f"{where}, resample",
            f"{step!r} s",
            f"a positive step that leaves at least {MINIMUM_SAMPLES} samples",
            "Choose a shorter one.",
        )
    rows = (raw.time[-1] - raw.time[0]) / step * (1.0 + 1e-12)
    check_memory(
        f"{where}, resample",
        f"{step:g} s, {rows:.3g} rows",
        _BYTES * rows * (1 + len(raw.signals)),
        f"Choose a longer step: the file's own is {old:g} s.",
    )
    count = int(rows) + 1
    time = raw.time[0] + step * np.arange(count)
    signals = {name: np.interp(time, raw.time, values) for name, values in raw.signals.items()}
    alias = " Nothing was filtered before: faster content is folded back." if step > 1.5 * old else ""
    warning = Problem(
        "warning",
        f"{where}, time",
        f"steps from {steps.min() * 1e3:.6g} to {steps.max() * 1e3:.6g} ms, resampled to {step * 1e3:.6g} ms "
        "by linear interpolation, as asked for",
        "a recording with equal steps",
        "What lies in gaps is invented: leave out windows with long ones." + alias,
    )
    return replace(raw, time=time, signals=signals), [warning]

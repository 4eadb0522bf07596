"""read_recording: a measurement file → Recording in SI, with all its problems found together."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InputProblems, InvalidInput, Problem
from ..recording import SIGNAL_UNITS, Recording
from .channels import Channel
from .checks import (
    MINIMUM_SAMPLES,
    Place,
    check_finite,
    check_increasing,
    check_length,
    check_raster,
    check_recording,
    rounded_to_decimals,
)
from .columns import Column, Table, short_list
from .units import COUNT_UNITS, parse_quantity

_DERIVED = {"speed_motor": "angle_motor", "speed_load": "angle_load"}


def read_recording(
    path: str | Path,
    *,
    time: Any = None,
    channels: Mapping[str, Any] | None = None,
    window: tuple[float, float] | None = None,
    resample: str | float | bool | None = None,
    count_averaged: bool | None = None,
) -> Recording:
    """Read a CSV, a MATLAB file up to version 7, or a recording that the package has saved (.npz).

    Parameters
    ----------
    path : path
    time : column, mapping or None
        Like a channel (s if no unit is stated), or ``{"sample_time": "0.1 ms"}`` where the file has no time.
        Default: the column named ``time`` or ``t``, or the time of Simulink's "structure with time".
    channels : mapping of signal → column or mapping
        See ``Channel``. Default: the columns that bear the name of a signal (``speed_motor [rpm]``).
    window : (start, stop), s
        Only start ≤ time < stop is read and checked.
    resample : str, float or bool
        Sample time of a new raster (``"0.1 ms"``, or s), True for the median step: linear interpolation.
    count_averaged : bool, optional
        Whether the file's motor speed is a mean over the last sample (count difference / step). Default: not
        said, and ``identify`` finds it, unless the file itself says it, the speed is derived here (then it
        is), or the file's numbers are rounded to decimals, which would look like counts (then it is not).

    Returns
    -------
    Recording
        SI; origin ``measured`` or ``derived``. ``meta`` holds ``file``, ``sha256``, ``sources``, ``problems``
        (the warnings), ``count_averaged`` where it is known, and for each derived speed how it was made. A
        speed that is missing is the difference of its angle over the last sample; the first row has none and
        is left out.

    Raises
    ------
    InputProblems
        All errors of the file together; the warnings that were found with them follow.
    """
    path, where = Path(path), str(path)
    data = _read_bytes(path)
    meta: dict[str, Any] = {}
    try:
        if data.startswith(b"PK\x03\x04"):
            saved = _saved(path, channels)
            raw = _Raw(saved.time, dict(saved.signals), lambda row: f"row {row}", {})
            origin, meta = dict(saved.origin), dict(saved.meta)
        else:
            raw = _from_table(_table(path, data), where, time, channels)
            origin = dict.fromkeys(raw.signals, "measured")
        raw = _checked(raw, where, window, resample)
    except InvalidInput as error:
        raise InputProblems([error.problem]) from None
    meta.update(file=where, sha256=hashlib.sha256(data).hexdigest(), sources=raw.sources)
    recording = _with_derived_speeds(Recording(raw.time, raw.signals, origin, meta=meta))
    if count_averaged is None and raw.rounded:
        # Else the decimals of the file would be taken for the counts of an encoder.
        count_averaged = False
    said = {} if count_averaged is None else {"count_averaged": bool(count_averaged)}
    problems = (*raw.warnings, *check_recording(recording))
    return replace(recording, meta={**recording.meta, **said, "problems": problems})


@dataclass(frozen=True, eq=False)
class _Raw:
    """Time and signals in SI before the checks; ``place`` names the line or row of a sample.

    ``rounded``: the motor speed stands in the file with few decimals.
    """

    time: NDArray[np.float64]
    signals: dict[str, NDArray[np.float64]]
    place: Place
    sources: dict[str, str]
    rounded: bool = False
    warnings: tuple[Problem, ...] = ()


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        if path.is_dir():
            got, remedy = "a folder", "Name the file in it."
        elif not path.exists():
            near = [p.name for p in path.parent.glob("*" + path.suffix)] if path.parent.is_dir() else []
            got = "no such file"
            remedy = f"In that folder: {short_list(sorted(near))}." if near else "Check the path."
        else:
            got, remedy = f"{error.strerror}", "Check the permissions."
        raise InputProblems([Problem("error", str(path), got, "a readable file", remedy)]) from None


def _table(path: Path, raw: bytes) -> Table:
    from .csv_files import read_csv
    from .matlab_files import read_mat

    if path.suffix.lower() == ".mat" or raw.startswith((b"MATLAB", b"\x89HDF")):
        return read_mat(path, raw)
    return read_csv(path, raw)


def _saved(path: Path, channels: Mapping[str, Any] | None) -> Recording:
    from .storage import load_recording

    recording = load_recording(path)
    if channels:
        raise InvalidInput(
            str(path),
            "channels for a saved recording",
            "none",
            "Leave them out: names and units are stored in it.",
        )
    return recording


def _from_table(table: Table, where: str, time: Any, channels: Mapping[str, Any] | None) -> _Raw:
    """The columns asked for, in SI; all errors together."""
    specs, problems = _specs(table, where, time, channels)
    columns, more = table.columns({name: channel.column for name, channel in specs.items()})
    problems += more
    signals: dict[str, NDArray[Any]] = {}
    for name, column in columns.items():
        try:
            signals[name] = specs[name].to_si(column, name, f"{where}, {name} ({column.label})")
        except InvalidInput as error:
            problems.append(error.problem)
        else:
            disagreement = specs[name].disagreement(column, f"{where}, {name} ({column.label})")
            problems += [] if disagreement is None else [disagreement]
    _stop_at_errors(problems)
    if isinstance(time, Mapping) and "sample_time" in time:
        step = _sample_time(time, where)
        signals["time"] = step * np.arange(next(iter(signals.values())).size)
    place = next(iter(columns.values())).place
    sources = {name: column.label for name, column in columns.items() if name != "time"}
    return _Raw(signals.pop("time"), signals, place, sources, _rounded_speed(specs, columns), tuple(problems))


def _rounded_speed(specs: Mapping[str, Channel], columns: Mapping[str, Column]) -> bool:
    speed = columns.get("speed_motor")
    if speed is None or (specs["speed_motor"].unit or speed.unit) in COUNT_UNITS:
        return False
    return rounded_to_decimals(speed.values)


def _specs(
    table: Table, where: str, time: Any, channels: Mapping[str, Any] | None
) -> tuple[dict[str, Channel], list[Problem]]:
    """The channel of every signal and of the time, and the problems with what was asked for."""
    known = table.known_signals()
    wanted: dict[str, Any] = dict(channels or {n: c for n, c in known.items() if n != "time"})
    problems: list[Problem] = []
    if not wanted:
        expected = "columns that bear the names of signals: " + ", ".join(SIGNAL_UNITS)
        remedy = "Say which column is which: channels.speed_motor = { column = ..., unit = ... }."
        problems.append(Problem("error", where, "no channels", expected, remedy))
    specs: dict[str, Channel] = {}
    if isinstance(time, Mapping) and "sample_time" in time:
        if set(time) != {"sample_time"}:
            remedy = "Leave the rest out, or give a column."
            problems.append(
                Problem("error", f"{where}, time", f"keys {sorted(time)}", "sample_time alone", remedy)
            )
    else:
        wanted["time"] = time
    for name, spec in wanted.items():
        try:
            if name == "time" and spec is None:
                first = next(iter(specs.values())).column if specs else ""
                spec = known.get("time", table.time_of(first))
                if spec is None:
                    raise InvalidInput(
                        f"{where}, time",
                        "no time",
                        "a column, or a sample time",
                        'Give time = { column = 0, unit = "s" }, or time = { sample_time = "0.1 ms" }.',
                    )
            specs[name] = Channel.of(spec, f"{where}, {name}")
        except InvalidInput as error:
            problems.append(error.problem)
    return specs, problems


def _sample_time(time: Mapping[str, Any], where: str) -> float:
    step = parse_quantity(time["sample_time"], "s", f"{where}, time.sample_time")
    if step <= 0.0:
        raise InvalidInput(f"{where}, time.sample_time", f"{step!r} s", "more than 0", "Check the sign.")
    return step


def _stop_at_errors(problems: list[Problem]) -> None:
    if any(problem.severity == "error" for problem in problems):
        raise InputProblems(problems)


def _checked(
    raw: _Raw, where: str, window: tuple[float, float] | None, resample: str | float | bool | None
) -> _Raw:
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

    problems = check_length(time.size, where)
    for name, values in raw.signals.items():
        problems += check_finite(name, values[rows], where, place)
    warnings: list[Problem] = []
    if resample is None or resample is False:
        problems += check_raster(time, where, place) if time.size > 2 else []
    _stop_at_errors(problems)
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


def _resampled(raw: _Raw, where: str, resample: str | float | bool) -> tuple[_Raw, list[Problem]]:
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
    count = int((raw.time[-1] - raw.time[0]) / step * (1.0 + 1e-12)) + 1
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


def _with_derived_speeds(recording: Recording) -> Recording:
    """Speeds from angles where they are missing: the difference over the last sample, first row left out."""
    missing = {s: a for s, a in _DERIVED.items() if s not in recording and a in recording}
    if not missing:
        return recording
    speeds = {s: np.diff(recording[a]) / np.diff(recording.time) for s, a in missing.items()}
    meta = {**recording.meta, **{s: f"mean over the sample, from {a}" for s, a in missing.items()}}
    if "speed_motor" in missing:
        meta["count_averaged"] = True
    return replace(
        recording,
        time=recording.time[1:],
        signals={**{name: values[1:] for name, values in recording.signals.items()}, **speeds},
        origin={**recording.origin, **dict.fromkeys(speeds, "derived")},
        meta=meta,
    )

"""read_recording: a measurement file → Recording in SI, with all its problems found together."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...argument_checks import checks_arguments
from ...errors import InputProblems, InvalidInput
from ...recording import Recording
from ..storage.whole_files import read_bytes
from ..tables.columns import Table
from .checks import check_recording
from .raw_signals import RawSignals, signals_of_table
from .window import checked

_DERIVED = {"speed_motor": "angle_motor", "speed_load": "angle_load"}


@checks_arguments
def read_recording(
    path: str | Path,
    *,
    time: Any = None,
    channels: Mapping[str, Any] | None = None,
    window: tuple[float, float] | None = None,
    resample: str | float | bool | None = None,
    speed_from_counts: bool | None = None,
) -> Recording:
    """Read a CSV, a MATLAB file up to version 7, or a recording that the package has saved (.npz).

    Parameters
    ----------
    path : path
    time : column, mapping or None
        Like a channel (s if no unit is stated), or ``{"sample_time": "0.1 ms"}`` where the file has no time.
        Default: the column named ``time`` or ``t`` (or alike), or the time of Simulink's "structure with time".
    channels : mapping of signal → column or mapping
        See ``Channel``. Default: the columns that bear the name of a signal (``speed_motor [rpm]``).
    window : (start, stop), s
        Only start ≤ time < stop is read and checked.
    resample : str, float or bool
        Sample time of a new raster (``"0.1 ms"``, or s), True for the median step: linear interpolation.
    speed_from_counts : bool, optional
        Whether the file's motor speed is a mean over the last sample (count difference / step). Default: not
        said, and ``identify`` finds it, unless the file itself says it, the speed is derived here (then it
        is), or the file's numbers are rounded to decimals, which would look like counts (then it is not).

    Returns
    -------
    Recording
        SI; origin ``measured`` or ``derived``. ``meta`` holds ``file``, ``sha256``, ``sources``, ``problems``
        (the warnings), ``speed_from_counts`` where it is known, and for each derived speed how it was made. A
        speed that is missing is the difference of its angle over the last sample; the first row has none and
        is left out.

    Raises
    ------
    InputProblems
        All errors of the file together; the warnings that were found with them follow.
    """
    path, where = Path(path), str(path)
    meta: dict[str, Any] = {}
    try:
        data = read_bytes(path)
        if data.startswith(b"PK\x03\x04"):
            saved = _saved(data, where, channels)
            raw = RawSignals(saved.time, dict(saved.signals), lambda row: f"row {row}", {})
            origin, meta = dict(saved.origin), dict(saved.meta)
        else:
            raw = signals_of_table(_table(path, data), where, time, channels)
            origin = dict.fromkeys(raw.signals, "measured")
        raw = checked(raw, where, window, resample)
    except InvalidInput as error:
        raise InputProblems([error.problem]) from None
    meta.update(file=where, sha256=hashlib.sha256(data).hexdigest(), sources=raw.sources)
    recording = _with_derived_speeds(Recording(raw.time, raw.signals, origin, meta=meta))
    if speed_from_counts is None and raw.rounded:
        # Else the decimals of the file would be taken for the counts of an encoder.
        speed_from_counts = False
    said = {} if speed_from_counts is None else {"speed_from_counts": bool(speed_from_counts)}
    problems = (*raw.warnings, *check_recording(recording))
    return replace(recording, meta={**recording.meta, **said, "problems": problems})


def _table(path: Path, raw: bytes) -> Table:
    suffix = ".mat" if raw.startswith((b"MATLAB", b"\x89HDF")) else path.suffix.lower()
    return READERS.get(suffix, _csv)(path, raw)


def _csv(path: Path, raw: bytes) -> Table:
    from ..tables.csv_files import read_csv

    return read_csv(path, raw)


def _mat(path: Path, raw: bytes) -> Table:
    from ..tables.matlab_files import read_mat

    return read_mat(path, raw)


#: Suffix → what makes a table of a file's path and bytes; files of other suffixes are taken for CSV.
READERS: dict[str, Callable[[Path, bytes], Table]] = {".csv": _csv, ".mat": _mat}


def _saved(data: bytes, where: str, channels: Mapping[str, Any] | None) -> Recording:
    from ..storage.recording_files import recording_in

    recording = recording_in(data, where)
    if channels:
        raise InvalidInput(
            where,
            "channels for a saved recording",
            "none",
            "Leave them out: names and units are stored in it.",
        )
    return recording


def _with_derived_speeds(recording: Recording) -> Recording:
    """Speeds from angles where they are missing: the difference over the last sample, first row left out."""
    missing = {s: a for s, a in _DERIVED.items() if s not in recording and a in recording}
    if not missing:
        return recording
    speeds = {s: np.diff(recording[a]) / np.diff(recording.time) for s, a in missing.items()}
    meta = {**recording.meta, **{s: f"mean over the sample, from {a}" for s, a in missing.items()}}
    if "speed_motor" in missing:
        meta["speed_from_counts"] = True
    return replace(
        recording,
        time=recording.time[1:],
        signals={**{name: values[1:] for name, values in recording.signals.items()}, **speeds},
        origin={**recording.origin, **dict.fromkeys(speeds, "derived")},
        meta=meta,
    )

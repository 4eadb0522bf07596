"""The package's own files: JSON and npz with kind and schema version.

The same content gives the same bytes: numbers are written by ``repr``, npz members bear the fixed date 1980.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InvalidInput, Problem
from ...events import Event, Events
from ...recording import Recording
from .whole_files import read_bytes, write_bytes

if TYPE_CHECKING:
    from ...systems import DiscreteSystem, Stepper

#: Raised by one whenever an older package could no longer read the files.
SCHEMA_VERSION = 2

#: Versions that are still read; what differs is brought up to date by the type that the content makes.
READABLE = (1, SCHEMA_VERSION)

#: Keys of a recording's meta that schema version 1 calls otherwise.
_RENAMED = {"count_averaged": "speed_from_counts"}


def save_json(path: str | Path, kind: str, data: Mapping[str, Any]) -> None:
    """Write a mapping as JSON with its kind and the schema version on top.

    Arrays become lists, tuples lists, paths text; NaN and infinity, which JSON does not know, become null.

    Raises
    ------
    InvalidInput
        If a value is of a kind that JSON cannot hold, or the file cannot be written.
    """
    content = {"kind": kind, "schema_version": SCHEMA_VERSION, **_plain(data, str(path))}
    write_bytes(
        Path(path), (json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode()
    )


def load_json(path: str | Path, kind: str) -> dict[str, Any]:
    """The mapping that ``save_json`` wrote, without kind and schema version.

    Raises
    ------
    InvalidInput
        If the file cannot be read, is no JSON, or is of another kind or a newer schema version.
    """
    raw = read_bytes(Path(path))
    try:
        content = json.loads(raw)
    except ValueError as error:
        raise InvalidInput(
            str(path), f"broken JSON: {error}", f"a {kind} as JSON", "Write it again."
        ) from None
    return unwrapped(content, kind, str(path))


def save_law(system: DiscreteSystem | Stepper, path: str | Path) -> None:
    """Write a ``DiscreteSystem`` or a ``Stepper`` as JSON; see ``load_law``."""
    save_json(path, "law", system.to_dict())


def load_law(path: str | Path) -> DiscreteSystem | Stepper:
    """The ``DiscreteSystem`` or ``Stepper`` that ``save_law`` wrote, equal to the last bit."""
    from ...systems import DiscreteSystem, Stepper

    content = load_json(path, "law")
    return (
        Stepper.from_dict(content)
        if {"estimator", "kernel"} & set(content)
        else DiscreteSystem.from_dict(content)
    )


def save_recording(recording: Recording, path: str | Path) -> None:
    """Write a recording with origin, events, final state and meta as .npz.

    Raises
    ------
    InvalidInput
        If meta or final_state hold what JSON cannot, or the file cannot be written.
    """
    header = {
        "kind": "recording",
        "schema_version": SCHEMA_VERSION,
        "origin": dict(recording.origin),
        "events": [list(event) for event in recording.events],
        "final_state": _plain(recording.final_state, f"{path}, final_state", tagged=True),
        "meta": _plain(recording.meta, f"{path}, meta", tagged=True),
    }
    arrays = {f"signal/{name}": values for name, values in recording.signals.items()}
    buffer = io.BytesIO()
    np.savez(buffer, header=np.array(json.dumps(header)), time=recording.time, **arrays)  # type: ignore[arg-type]
    write_bytes(Path(path), buffer.getvalue())


def load_recording(path: str | Path) -> Recording:
    """The recording that ``save_recording`` wrote, equal to the last bit (tuples in meta come back as lists).

    Raises
    ------
    InvalidInput
        If the file cannot be read, is damaged, or is not a recording of a known schema version.
    """
    raw = read_bytes(Path(path))
    try:
        with np.load(io.BytesIO(raw), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        header = json.loads(str(arrays["header"]))
    except (ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile) as error:
        got = "no recording of this package" if isinstance(error, KeyError) else "a damaged file"
        raise InvalidInput(
            str(path),
            got,
            "an .npz written by save_recording",
            "Copy it again; save a spreadsheet as CSV.",
        ) from None
    header = unwrapped(header, "recording", str(path))
    meta = {_RENAMED.get(key, key): value for key, value in _untagged(header["meta"]).items()}
    return Recording(
        arrays["time"],
        {n.removeprefix("signal/"): values for n, values in arrays.items() if n.startswith("signal/")},
        header["origin"],
        Events.of(Event(*event) for event in header["events"]),
        _untagged(header["final_state"]),
        meta,
    )


def unwrapped(content: Any, kind: str, where: str) -> dict[str, Any]:
    """The content without kind and schema version, both checked."""
    found = content.get("kind") if isinstance(content, dict) else None
    if found != kind:
        raise InvalidInput(where, f"kind {found!r}", f"kind {kind!r}", "Name the right file.")
    version = content.get("schema_version")
    if version not in READABLE:
        raise InvalidInput(
            where,
            f"schema_version {version!r}",
            f"schema_version {' or '.join(map(str, READABLE))}",
            "Read it with the version of the package that wrote it, or write it again.",
        )
    return {key: value for key, value in content.items() if key not in ("kind", "schema_version")}


def _plain(value: Any, where: str, tagged: bool = False) -> Any:
    """What JSON can hold; with ``tagged``, arrays and problems can be told from lists and mappings again."""
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.integer | np.bool_):
        return value.item()
    if isinstance(value, np.ndarray):
        numbers = _plain(value.tolist(), where)
        return {"__array__": numbers} if tagged else numbers
    if isinstance(value, Problem):
        return {"__problem__": value.as_dict()} if tagged else value.as_dict()
    if isinstance(value, Mapping):
        return {str(key): _plain(entry, f"{where}, {key}", tagged) for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(entry, where, tagged) for entry in value]
    if isinstance(value, Path):
        return value.as_posix()
    raise InvalidInput(
        where, f"a {type(value).__name__}", "numbers, text, lists, mappings, arrays", "Convert it."
    )


def _untagged(value: Any) -> Any:
    if isinstance(value, dict):
        if set(value) == {"__array__"}:
            return np.array(value["__array__"], dtype=float)
        if set(value) == {"__problem__"}:
            return Problem(**value["__problem__"])
        return {key: _untagged(entry) for key, entry in value.items()}
    return [_untagged(entry) for entry in value] if isinstance(value, list) else value

"""Recordings as .npz: signals, origin, events, final state and meta, equal when they are read back.

The same content gives the same bytes: members bear the fixed date 1980.
"""

from __future__ import annotations

import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...argument_checks import checks_arguments
from ...errors import InvalidInput, Problem, within
from ...events import Event, Events
from ...plain_data import entries, mapping, number, table, text
from ...recording import Recording
from .json_files import SCHEMA_VERSION, parsed_json, plain, unwrapped
from .npz_files import unpacked
from .whole_files import read_bytes, write_bytes

_EXPECTED = "an .npz written by save_recording"

#: Keys of a recording's meta that schema version 1 calls otherwise.
_RENAMED = {"count_averaged": "speed_from_counts"}

#: Names of mappings that stand for what JSON does not have.
_ARRAY, _PROBLEM, _NUMBER = "__array__", "__problem__", "__number__"
_NOT_FINITE = ("nan", "inf", "-inf")


@checks_arguments
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
        "final_state": _tagged(recording.final_state, f"{path}, final_state"),
        "meta": _tagged(recording.meta, f"{path}, meta"),
    }
    arrays = {f"signal/{name}": values for name, values in recording.signals.items()}
    buffer = io.BytesIO()
    np.savez(buffer, header=np.array(json.dumps(header)), time=recording.time, **arrays)  # type: ignore[arg-type]
    write_bytes(path, buffer.getvalue())


@checks_arguments
def load_recording(path: str | Path) -> Recording:
    """The recording that ``save_recording`` wrote, equal to the last bit (tuples in meta come back as lists).

    Raises
    ------
    InvalidInput
        If the file cannot be read, is damaged, takes more than the memory limit, or is not a recording of a known
        schema version.
    """
    return recording_in(read_bytes(path), str(path))


def recording_in(raw: bytes, where: str) -> Recording:
    """The recording in the bytes of a file that was read already."""
    arrays = unpacked(raw, where, _EXPECTED)
    if not {"header", "time"} <= set(arrays) or arrays["header"].dtype.kind != "U":
        raise InvalidInput(
            where, "no recording of this package", _EXPECTED, "Copy it again; save a spreadsheet as CSV."
        )
    header = unwrapped(parsed_json(str(arrays["header"]), where, _EXPECTED), "recording", where)
    with within(where):
        header = table("header", header, ("origin", "events", "final_state", "meta"))
        meta = mapping("meta", _untagged(mapping("meta", header["meta"]), "meta"))
        return Recording(
            _floats("time", arrays["time"]),
            {
                name.removeprefix("signal/"): _floats(name, values)
                for name, values in arrays.items()
                if name.startswith("signal/")
            },
            {name: text(f"origin, {name}", one) for name, one in mapping("origin", header["origin"]).items()},
            Events.of(
                _event(f"events[{i}]", one) for i, one in enumerate(entries("events", header["events"]))
            ),
            mapping("final_state", _untagged(mapping("final_state", header["final_state"]), "final_state")),
            {_RENAMED.get(key, key): value for key, value in meta.items()},
        )


def _floats(where: str, array: np.ndarray) -> np.ndarray:
    if array.dtype.kind != "f" or array.ndim != 1:
        raise InvalidInput(
            where, f"{array.dtype} of shape {array.shape}", "a row of floats", "Write it with save_recording."
        )
    return array


def _event(where: str, row: object) -> Event:
    """An event; files of older versions hold no energies."""
    values = entries(where, row)
    if len(values) not in (4, 5):
        raise InvalidInput(
            where, f"{len(values)} values", "5: time, kind, place, speed, energy", "Write it again."
        )
    time, speed, *energy = (number(where, values[i]) for i in (0, 3, 4)[: len(values) - 2])
    return Event(time, text(where, values[1]), text(where, values[2]), speed, *energy)


def _tagged(value: Any, where: str) -> Any:
    """What JSON can hold, from which arrays, problems, NaN and infinity can be read again."""
    if isinstance(value, float | np.floating) and not math.isfinite(value):
        return {_NUMBER: repr(float(value))}
    if isinstance(value, np.ndarray):
        return {_ARRAY: _tagged(value.tolist(), where), "shape": list(value.shape)}
    if isinstance(value, Problem):
        return {_PROBLEM: value.as_dict()}
    if isinstance(value, Mapping):
        if {str(key) for key in value} & {_ARRAY, _PROBLEM, _NUMBER}:
            raise InvalidInput(where, "a key that begins with __", "a name of yours", "Rename it.")
        return {str(key): _tagged(entry, f"{where}, {key}") for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return [_tagged(entry, where) for entry in value]
    return plain(value, where)


def _untagged(value: Any, where: str) -> Any:
    """What `_tagged` was given."""
    if isinstance(value, list):
        return [_untagged(entry, where) for entry in value]
    if not isinstance(value, dict):
        return value
    if _NUMBER in value:
        said = text(where, table(where, value, (_NUMBER,))[_NUMBER])
        return number(where, said) if said not in _NOT_FINITE else float(said)
    if _PROBLEM in value:
        fields = table(where, table(where, value, (_PROBLEM,))[_PROBLEM], Problem.__dataclass_fields__)
        return Problem(**{name: text(f"{where}, {name}", entry) for name, entry in fields.items()})  # type: ignore[arg-type]
    if _ARRAY in value:
        content = table(where, value, (_ARRAY,), ("shape",))
        return _array(where, _untagged(content[_ARRAY], where), content.get("shape"))
    return {key: _untagged(entry, f"{where}, {key}") for key, entry in value.items()}


def _array(where: str, value: Any, shape: Any) -> np.ndarray:
    """An array out of nested lists; the shape, which older versions did not write, keeps that of an empty one."""
    try:
        array = np.array(value, dtype=float)
        return array if shape is None else array.reshape(shape)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(
            where, "no array of numbers", "nested lists of numbers", "Write it again."
        ) from None

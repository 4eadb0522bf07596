"""The package's own JSON: with kind and schema version on top, strict when it is read.

The same content gives the same bytes: numbers are written by ``repr``.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from ...argument_checks import checks_arguments
from ...errors import InvalidInput, Problem
from ...plain_data import shown
from .whole_files import read_bytes, write_bytes

#: Raised by one whenever an older package could no longer read the files (layout).
SCHEMA_VERSION = 2

#: Versions that are still read (layout); what differs is brought up to date by the type that the content makes.
READABLE = (1, SCHEMA_VERSION)

#: Endings of files of other kinds that are named by mistake.
_OTHERS = (".toml", ".csv", ".npz", ".mat", ".png", ".py", ".c", ".h")

#: Where a file comes from, by its kind.
_WRITTEN = {
    "law": "Name the right file: a run writes one, law.json, into its output folder.",
    "drivetrain": "Name the right file: a run writes one, drivetrain.toml, into its output folder.",
}

#: Memory that JSON takes once it is read, as a multiple of its text (calibrated on lists of floats: 5).
_TAKES = 6.0


@checks_arguments
def save_json(path: str | Path, kind: str, data: Mapping[str, Any]) -> None:
    """Write a mapping as JSON with its kind and the schema version on top.

    Arrays become lists, tuples lists, paths text; NaN and infinity, which JSON does not know, become null.

    Raises
    ------
    InvalidInput
        If a value is of a kind that JSON cannot hold, or the file cannot be written.
    """
    content = {"kind": kind, "schema_version": SCHEMA_VERSION, **plain(data, str(path))}
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    # A name of a file may hold what is no text: JSON's own escape of it is what backslashreplace writes.
    write_bytes(path, text.encode(errors="backslashreplace"))


@checks_arguments
def load_json(path: str | Path, kind: str) -> dict[str, Any]:
    """The mapping that ``save_json`` wrote, without kind and schema version.

    Raises
    ------
    InvalidInput
        If the file cannot be read, is no JSON, or is of another kind or a newer schema version.
    """
    return unwrapped(read_json(path, kind), kind, str(path))


def read_json(path: str | Path, kind: str) -> Any:
    """What a JSON file of that kind holds, as it stands there."""
    return parsed_json(read_bytes(path, takes=_TAKES), str(path), f"a {kind} as JSON")


def parsed_json(raw: bytes | str, where: str, expected: str) -> Any:
    """JSON without doubled keys, NaN and infinity, which other readers take otherwise."""
    if not raw.strip():
        raise InvalidInput(where, "an empty file", expected, "Copy or write it again.")
    try:
        return json.loads(raw, object_pairs_hook=_once, parse_constant=_no_number)
    except RecursionError:
        got = "hundreds of brackets in each other"
    except ValueError as error:
        got = f"broken JSON: {error}"
        ending = Path(where).suffix
        if ending.lower() in _OTHERS:
            raise InvalidInput(
                where, f"a file with the ending {ending!r} that is no JSON", expected, "Name the right file."
            ) from None
    raise InvalidInput(where, got, expected, "Write it again.")


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"the key {shown(next(n for n in names if names.count(n) > 1))} comes twice")
    return found


def _no_number(text: str) -> NoReturn:
    raise ValueError(f"{text} is no number in JSON")


def unwrapped(content: Any, kind: str, where: str) -> dict[str, Any]:
    """The content without kind and schema version, both checked."""
    found = content.get("kind") if isinstance(content, dict) else None
    if found != kind:
        got = "nothing that says its kind" if found is None else f"kind {shown(found)}"
        raise InvalidInput(where, got, f"kind {kind!r}", _WRITTEN.get(kind, "Name the right file."))
    version = content.get("schema_version")
    if isinstance(version, bool) or version not in READABLE:
        raise InvalidInput(
            where,
            f"schema_version {shown(version)}",
            f"schema_version {' or '.join(map(str, READABLE))}",
            "Read it with the version of the package that wrote it, or write it again.",
        )
    return {key: value for key, value in content.items() if key not in ("kind", "schema_version")}


def plain(value: Any, where: str) -> Any:
    """What JSON can hold."""
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.integer | np.bool_):
        return value.item()
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), where)
    if isinstance(value, Problem):
        return value.as_dict()
    if isinstance(value, Mapping):
        return {str(key): plain(entry, f"{where}, {key}") for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return [plain(entry, where) for entry in value]
    if isinstance(value, Path):
        return value.as_posix()
    raise InvalidInput(
        where, f"a {type(value).__name__}", "numbers, text, lists, mappings, arrays", "Convert it."
    )

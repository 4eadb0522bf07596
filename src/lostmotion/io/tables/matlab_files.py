"""MATLAB files up to version 7: arrays, structs, cell arrays, and Simulink's "structure with time"."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import InvalidInput, Problem
from ...recording import SIGNAL_UNITS
from ..isolation.parent import read_isolated
from ..spelling import short_list, split_unit, suggestion
from .columns import Column

_HDF5 = b"\x89HDF\r\n\x1a\n"
_STEP = re.compile(r"\.?(?P<name>[A-Za-z_]\w*)|[\[{](?P<index>[-\d:, ]+)[\]}]", re.ASCII)
#: Structs in structs are listed so deep in messages (option).
_DEEPEST = 10
_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_TIME_NAMES = ("t", "time", "Time")


def _plain(value: Any) -> Any:
    """A 1×1 struct, cell or object as what it holds."""
    while isinstance(value, np.ndarray) and value.size == 1 and (value.dtype == object or value.dtype.names):
        value = value.flat[0]
    return value


def _fields(value: Any) -> tuple[str, ...]:
    return tuple(value.dtype.names or ()) if isinstance(value, np.ndarray | np.void) else ()


def _text(value: Any) -> str:
    """A MATLAB text, "" for anything else."""
    value = np.asarray(_plain(value))
    return str(value.flat[0]).strip() if value.dtype.kind == "U" and value.size else ""


def _with_time(value: Any) -> Iterator[tuple[str, Any]]:
    """(label, values) of every signal of a Simulink "structure with time"; nothing for any other value."""
    value = _plain(value)
    if "signals" not in _fields(value):
        return
    signals = _plain(value["signals"])
    for entry in signals.ravel() if isinstance(signals, np.ndarray) else (signals,):
        names = _fields(_plain(entry))
        if "values" in names:
            signal = _plain(entry)
            yield (_text(signal["label"]) if "label" in names else ""), signal["values"]


def _pick(value: Any, index: str) -> Any:
    """One index ``[2]`` counts from 0 along the shorter side; ``[:,5]`` and ``[5,:]`` say the side."""
    value = np.asarray(_plain(value))
    parts = [part.strip() for part in index.split(",")]
    if len(parts) == 1 and parts[0] != ":":
        if value.dtype == object or value.dtype.names:
            return value.ravel()[int(parts[0])]
        axis = int(np.argmin(value.shape)) if value.ndim > 1 else 0
        return np.take(value, int(parts[0]), axis=axis)
    return value[tuple(slice(None) if part == ":" else int(part) for part in parts)]


@dataclass(frozen=True, eq=False)
class MatTable:
    """The variables of a MATLAB file, found by paths such as ``data[:,5]`` or ``rec.act_pos_mot_deg[2]``."""

    where: str
    variables: Mapping[str, Any]

    def paths(self) -> list[str]:
        """Path and shape of every array of numbers in the file."""
        found: list[str] = []
        for name, value in self.variables.items():
            self._walk(name, value, found)
        return found

    def _walk(self, path: str, value: Any, found: list[str], depth: int = 0) -> None:
        value = _plain(value)
        names = _fields(value) if depth < _DEEPEST else ()
        labelled = [label for label, _ in _with_time(value) if label]
        if labelled:
            found += [f"{path}.{label}" for label in labelled]
        elif names and isinstance(value, np.void):
            for name in names:
                self._walk(f"{path}.{name}", value[name], found, depth + 1)
        elif isinstance(value, np.ndarray) and (value.dtype == object or value.dtype.names):
            for i, entry in enumerate(value.ravel()[:20] if depth < _DEEPEST else ()):
                self._walk(f"{path}[{i}]", entry, found, depth + 1)
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiub" and value.size > 1:
            flat = max(value.shape) == value.size
            found.append(
                path if flat else f"{path}[:,0]" if value.shape[0] > value.shape[1] else f"{path}[0]"
            )

    def resolve(self, path: str, where: str) -> tuple[Any, str]:
        """The value at a path, and the label that Simulink gave it.

        Raises
        ------
        InvalidInput
            If the path leads nowhere.
        """
        root = _NAME.match(path)
        value, label, at = (self.variables.get(root[0]) if root else None), "", root.end() if root else 0
        while value is not None and at < len(path):
            labels = dict(_with_time(value))
            wanted = path[at:].removeprefix(".")
            for name in labels:
                if wanted and wanted in (name, split_unit(name)[0]):
                    return labels[name], name
            step = _STEP.match(path, at)
            if step is None:
                value = None
                break
            value = self._step(value, step, where, path)
            at = step.end()
        if value is None:
            paths = self.paths()
            other = root is not None and root[0] in self.variables and self.variables[root[0]] is None
            raise InvalidInput(
                where,
                f"{path!r}, a sparse matrix, function or object" if other else f"no variable {path!r}",
                "a path such as " + short_list(paths, 20) if paths else "a file with arrays of numbers",
                "Save it as an array: full(x)." if other else suggestion(path, paths),
            )
        return value, label

    @staticmethod
    def _step(value: Any, step: re.Match[str], where: str, path: str) -> Any:
        if step["name"]:
            value = _plain(value)
            return value[step["name"]] if step["name"] in _fields(value) else None
        try:
            return _pick(value, step["index"])
        except (IndexError, ValueError, OverflowError):
            shape = np.shape(_plain(value))
            raise InvalidInput(
                where,
                f"index [{step['index']}] in {path!r}",
                f"one within the shape {shape}",
                "Indices count from 0; [:,5] is the sixth column.",
            ) from None

    def column(self, path: str | int, where: str) -> Column:
        """The numbers at a path, as one column."""
        if isinstance(path, int):
            raise InvalidInput(
                where,
                f"column {path}",
                "a path such as " + short_list(self.paths(), 20),
                f"E.g. data[:,{path}].",
            )
        value, label = self.resolve(path, where)
        array = np.asarray(_plain(value))
        if array.dtype.kind not in "fiub" or array.size < 2:
            kind = (
                f"a struct with the fields {short_list(_fields(array))}"
                if _fields(array)
                else f"{array.dtype}"
            )
            raise InvalidInput(
                where,
                f"{path!r} of {array.size} values ({kind})",
                "a vector of real numbers, one for each time",
                "Give a longer path."
                if array.dtype == object or _fields(array)
                else "Choose another variable.",
            )
        if max(array.shape) != array.size:
            raise InvalidInput(
                where,
                f"{path!r} of shape {array.shape}",
                "one column",
                f"Say which one: {path}[:,0] or {path}[0,:], counted from 0.",
            )
        return Column(array.ravel().astype(float), split_unit(label)[1], f"variable {path}")

    def columns(self, keys: dict[str, str | int]) -> tuple[dict[str, Column], list[Problem]]:
        found: dict[str, Column] = {}
        problems: list[Problem] = []
        for name, key in keys.items():
            try:
                found[name] = self.column(key, f"{self.where}, {name}")
            except InvalidInput as error:
                problems.append(error.problem)
        return found, problems + _unequal(self.where, found)

    def known_signals(self) -> dict[str, str | int]:
        found: dict[str, str | int] = {}
        for name, value in self.variables.items():
            for label, _ in _with_time(value):
                if split_unit(label)[0] in SIGNAL_UNITS:
                    found[split_unit(label)[0]] = f"{name}.{label}"
                    found["time"] = f"{name}.time"
        found.update({name: name for name in self.variables if name in SIGNAL_UNITS})
        times: list[str | int] = [name for name in _TIME_NAMES if name in self.variables]
        return {**found, "time": times[0]} if times else found

    def time_of(self, key: str | int) -> str | int | None:
        """Path of the time that belongs to a column: that of its "structure with time"."""
        root = _NAME.match(str(key))
        value = _plain(self.variables.get(root[0])) if root else None
        return (
            f"{root[0]}.time" if root and "time" in _fields(value) and "signals" in _fields(value) else None
        )


def _unequal(where: str, found: dict[str, Column]) -> list[Problem]:
    lengths = {name: column.values.size for name, column in found.items()}
    if len(set(lengths.values())) < 2:
        return []
    return [
        Problem(
            "error",
            where,
            "lengths " + ", ".join(f"{name} {n}" for name, n in lengths.items()),
            "one value of every channel for each time",
            "Choose channels of the same recording, or one row of a matrix.",
        )
    ]


def read_mat(path: Path, raw: bytes) -> MatTable:
    """Read a MATLAB file of version 4 to 7.

    Raises
    ------
    InvalidInput
        If it is of version 7.3 (HDF5), or no MATLAB file, or cut off.
    """
    where = str(path)
    if raw.startswith(_HDF5) or raw[512:520] == _HDF5 or raw.startswith(b"MATLAB 7.3"):
        raise InvalidInput(
            where,
            "a MATLAB file of version 7.3 (HDF5)",
            "a MATLAB file of version 7 or older",
            f"In MATLAB: load('{path.name}'), then save('{path.name}', '-v7').",
        )
    variables = read_isolated(
        "mat",
        raw,
        where,
        "a complete MATLAB file of version 4 to 7",
        "Copy it again, or save it in MATLAB with '-v7'.",
    )
    return MatTable(where, variables)

"""Finished chunks of a batch in a folder: the same batch goes on after them, another one is refused."""

from __future__ import annotations

import functools
import hashlib
import json
import pickle
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...kernels.fresh_cache import combined_hash
from .chunk import Chunk, Work, write_whole

_COLUMNS = ("final_state", "peak", "rms", "events", "samples", "time")

#: What a batch runs through: this layer and all below it.
SOURCES = (
    "simulation", "systems", "metrics", "drivetrain", "recording", "signals", "curves", "events",
    "argument_checks", "plain_data", "memory", "kernels", "errors", "display", "version",
)  # fmt: skip


@functools.cache
def source_hash(package: Path = Path(__file__).parents[2]) -> str:
    """Hash of all sources of the package that a batch may depend on."""
    names = {path: path.relative_to(package).as_posix() for path in package.rglob("*.py")}
    used = {n: p.read_bytes() for p, n in names.items() if n.removesuffix(".py").split("/")[0] in SOURCES}
    return combined_hash(used)


class Store:
    """One file for each chunk, named by its first variant, with hashes of all that it was made from.

    Raises ``InvalidInput`` if the folder cannot be made, or holds chunks that were made from anything else. Chunks by
    other sources of the package are no batch that could go on: they are worked out again.
    """

    def __init__(
        self, folder: Path, work: Work, chunk: int, parts: Mapping[int, Sequence[Drivetrain]]
    ) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InvalidInput(
                str(folder), error.strerror or "an error", "a folder to write to", "Choose another."
            ) from None
        self.folder = folder
        made_from = {
            "dt": work.dt,
            "signals": work.signals,
            "quantiles": work.quantiles,
            "trajectories": work.trajectories,
            "chunk": chunk,
            **{name: value for name, value in work.arguments.items() if value is not None},
        }
        self._made_from = {name: _hash(pickle.dumps(value)) for name, value in made_from.items()}
        self.finished: dict[int, Chunk] = {}
        self._read(parts)

    def file(self, start: int) -> Path:
        return self.folder / f"variants-{start:06d}"

    def write(self, start: int, part: Sequence[Drivetrain], chunk: Chunk) -> None:
        arrays: dict[str, Any] = {name: getattr(chunk, name) for name in _COLUMNS}
        made_from = {
            "sources": source_hash(),
            "arguments": self._made_from,
            "drivetrains": [_hash(repr(drivetrain).encode()) for drivetrain in part],
        }
        arrays |= {"made_from": json.dumps(made_from), "failures": json.dumps(chunk.failures)}
        arrays["sha256"] = _hash_of(arrays)
        write_whole(self.file(start).with_suffix(".summary.npz"), arrays)

    def _read(self, parts: Mapping[int, Sequence[Drivetrain]]) -> None:
        """Keeps the chunks that stand."""
        others: set[str] = set()
        for file in sorted(self.folder.glob("variants-*.summary.npz")):
            stands = _chunk(file)
            if stands is None:
                continue
            made_from, chunk = stands
            start = int(file.name.removeprefix("variants-").removesuffix(".summary.npz"))
            other = _differing(made_from["arguments"], self._made_from)
            drivetrains = [_hash(repr(drivetrain).encode()) for drivetrain in parts.get(start, ())]
            # The last chunk of fewer or more variants of the same is shorter or longer.
            if any(a != b for a, b in zip(drivetrains, made_from["drivetrains"], strict=False)):
                other.add("drivetrains")
            others |= other
            if not other and len(drivetrains) == len(made_from["drivetrains"]):
                self.finished[start] = chunk
        if others:
            raise InvalidInput(
                str(self.folder),
                "chunks of a batch that differs in " + ", ".join(sorted(others)),
                "chunks of this batch, or none",
                "Give the options that it was begun with, to go on; or delete the folder; or choose another.",
            )


def _chunk(file: Path) -> tuple[dict[str, Any], Chunk] | None:
    """What a file's chunk was made from, and the chunk; None for none, a damaged one, or one of other sources."""
    try:
        with np.load(file, allow_pickle=False) as data:
            arrays = dict(data)
    except Exception:  # zipfile and numpy raise many kinds on a damaged file
        return None
    if "sha256" not in arrays or str(arrays.pop("sha256")) != _hash_of(arrays):
        return None
    made_from = json.loads(str(arrays["made_from"]))
    if made_from["sources"] != source_hash():
        return None
    failures = {int(i): text for i, text in json.loads(str(arrays["failures"])).items()}
    return made_from, Chunk(failures, **{name: arrays[name] for name in _COLUMNS})


def _differing(one: Mapping[str, str], two: Mapping[str, str]) -> set[str]:
    names: Iterable[str] = {*one, *two}
    return {name for name in names if one.get(name) != two.get(name)}


def _hash_of(arrays: Mapping[str, Any]) -> str:
    """Hash of all arrays with their names, types and shapes."""
    values = {name: np.asarray(arrays[name]) for name in sorted(arrays)}
    parts = [f"{name} {v.dtype.str} {v.shape} ".encode() + v.tobytes() for name, v in values.items()]
    return _hash(b"".join(parts))


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()

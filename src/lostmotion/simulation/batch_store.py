"""Finished chunks of a batch in a folder; one that was made from anything else is worked out again."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .batch_chunk import Chunk, Work, write_whole

_COLUMNS = ("final_state", "peak", "rms", "events", "samples", "time")


class Store:
    """One file for each chunk, named by its first variant."""

    def __init__(self, folder: Path, work: Work, chunk: int) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InvalidInput(
                str(folder), error.strerror or "an error", "a folder to write to", "Choose another."
            ) from None
        self.folder = folder
        self.key = pickle.dumps(
            (work.dt, work.signals, work.quantiles, work.trajectories, work.arguments, chunk)
        )

    def file(self, start: int) -> Path:
        return self.folder / f"variants-{start:06d}"

    def _mark(self, part: Sequence[Drivetrain]) -> str:
        return hashlib.sha256(self.key + repr(part).encode()).hexdigest()

    def read(self, start: int, part: Sequence[Drivetrain]) -> Chunk | None:
        """The chunk, if it stands and was made from the same."""
        try:
            with np.load(self.file(start).with_suffix(".summary.npz"), allow_pickle=False) as data:
                if str(data["mark"]) != self._mark(part):
                    return None
                failures = {int(i): text for i, text in json.loads(str(data["failures"])).items()}
                return Chunk(failures, **{name: data[name] for name in _COLUMNS})
        except (OSError, KeyError, ValueError, EOFError, BadZipFile):  # half a file is no file
            return None

    def write(self, start: int, part: Sequence[Drivetrain], chunk: Chunk) -> None:
        arrays: dict[str, Any] = {name: getattr(chunk, name) for name in _COLUMNS}
        arrays |= {"mark": self._mark(part), "failures": json.dumps(chunk.failures)}
        write_whole(self.file(start).with_suffix(".summary.npz"), arrays)

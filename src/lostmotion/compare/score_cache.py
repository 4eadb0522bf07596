"""Scores kept in files: an interrupted comparison continues, and a change of the code starts it over."""

from __future__ import annotations

import functools
import json
from pathlib import Path

from ..errors import InvalidInput
from ..io.storage.json_files import read_json
from ..io.storage.whole_files import write_bytes
from ..kernels.fresh_cache import combined_hash
from ..plain_data import mapping, number
from .scores import Score

Scores = dict[str, Score]

#: Sources that no score depends on: the layers above, and the modules that make tables of scores.
ABOVE = (
    "cli", "run", "commands", "terminal", "interruption", "precompile", "stages", "experiment", "report",
    "plot", "export", "io", "paper", "realtime",
)  # fmt: skip
#: Of these one makes a law that is compared.
COMPARED = ("stages/target_law",)
TABLES = tuple(
    f"compare/{name}"
    for name in (
        "compare_observers", "comparison", "leaderboard", "names", "score_cache", "score_table", "statistics",
        "whole_table", "controllers/compare_controllers", "controllers/leaderboard",
    )
)  # fmt: skip


@functools.cache
def source_hash(package: Path = Path(__file__).parents[1]) -> str:
    """Hash of all sources of the package that a score may depend on."""
    sources = {path.relative_to(package).with_suffix("").as_posix(): path for path in package.rglob("*.py")}
    return combined_hash(
        {
            f"{name}.py": path.read_bytes()
            for name, path in sources.items()
            if name in COMPARED or (name.split("/")[0] not in ABOVE and name not in TABLES)
        }
    )


class ScoreCache:
    """Scores per case and seed, kept in files if there is a folder.

    Parameters
    ----------
    folder : Path or None
        Files go to ``scores`` in it.
    apart : str, optional
        Folder in ``scores``, for scores of other settings than those of other calls.

    Raises
    ------
    InvalidInput
        If the folder cannot be made.
    """

    def __init__(self, folder: Path | None, apart: str | None = None) -> None:
        self.folder = None if folder is None else folder / "scores" / (apart or "")
        self._found: dict[tuple[str, int], Scores] = {}
        if self.folder is not None:
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                raise InvalidInput(
                    str(folder), str(error.strerror or error), "a folder that can be written", "Name another."
                ) from None

    def scores(self, case: str, seed: int) -> Scores:
        """Known scores, by observer."""
        if (case, seed) not in self._found:
            self._found[case, seed] = self._read(case, seed)
        return self._found[case, seed]

    def add(self, case: str, seed: int, found: Scores) -> None:
        """Adds scores to those of other observers."""
        scores = self._found[case, seed] = {**self.scores(case, seed), **found}
        if self.folder is not None:
            content = {"sources": source_hash(), "case": case, "seed": seed, "scores": scores}
            write_bytes(self._path(case, seed), json.dumps(content, indent=1, allow_nan=False).encode())

    def _path(self, case: str, seed: int) -> Path:
        words = "".join(c if c.isalnum() or c in "+−." else "_" for c in case)
        return (self.folder or Path()) / f"{words}__{seed}.json"

    def _read(self, case: str, seed: int) -> Scores:
        """The file's scores; none from a damaged file or one made by other code."""
        if self.folder is None or not self._path(case, seed).is_file():
            return {}
        try:
            content = read_json(self._path(case, seed), "scores")
            if content["sources"] != source_hash():
                return {}
            return {
                name: _score(name, values) for name, values in mapping("scores", content["scores"]).items()
            }
        except (InvalidInput, KeyError, TypeError):
            return {}


def _score(where: str, values: object) -> Score:
    """Each of its numbers, or None."""
    return {name: None if v is None else number(where, v) for name, v in mapping(where, values).items()}

"""ScoreTable: scores by case, seed and entry, with medians over the seeds, as files."""

from __future__ import annotations

import csv
import io
import json
import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar

from ..io.storage.whole_files import write_bytes
from .scores import Score
from .statistics import Estimate, median


class AnyCase(Protocol):
    """What a table must know of a case."""

    @property
    def name(self) -> str: ...

    @property
    def group(self) -> str: ...


CaseType = TypeVar("CaseType", bound=AnyCase)


@dataclass(frozen=True, eq=False)
class ScoreTable(Generic[CaseType]):
    """Scores of all entries over all cases and seeds.

    Parameters
    ----------
    entries : mapping of name → kind
        In the order of their list.
    cases : tuple of Case
    seeds : tuple of int
    scores : mapping case → seed → entry → score
    settings : mapping
        Whether quick, whether the table is a part (cases or entries were chosen), length of the recordings.
    """

    entries: Mapping[str, str]
    cases: tuple[CaseType, ...]
    seeds: tuple[int, ...]
    scores: Mapping[str, Mapping[int, Mapping[str, Score]]]
    settings: Mapping[str, Any]

    #: What an entry is, for headings; every number of a score.
    ENTRY: ClassVar[str]
    METRICS: ClassVar[tuple[str, ...]]

    def values(self, entry: str, case: str, metric: str) -> dict[int, float]:
        """The metric by seed, where the entry has it."""
        found = {}
        for seed, row in self.scores[case].items():
            value = row.get(entry, {}).get(metric)
            if value is not None and math.isfinite(value):
                found[seed] = float(value)
        return found

    def median(self, entry: str, case: str, metric: str) -> Estimate | None:
        """Median over seeds with its 95 % interval; None where the entry has no such number."""
        values = self.values(entry, case, metric)
        return median(list(values.values())) if values else None

    def groups(self) -> tuple[str, ...]:
        """Groups of cases, in their order."""
        return tuple(dict.fromkeys(case.group for case in self.cases))

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Everything, for JSON."""

    @abstractmethod
    def to_markdown(self) -> str:
        """The tables for reading."""

    def to_csv(self) -> str:
        """One line for each case, seed and entry."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(["case", "group", "seed", self.ENTRY, *self.METRICS])
        for case in self.cases:
            name, group = case.name, case.group
            for seed, row in sorted(self.scores[name].items()):
                for entry in self.entries:
                    if entry in row:
                        cells = ["" if (v := row[entry].get(m)) is None else repr(v) for m in self.METRICS]
                        writer.writerow([name, group, seed, entry, *cells])
        return text.getvalue()

    def write(self, folder: Path) -> None:
        """leaderboard.json, leaderboard.csv and leaderboard.md."""
        content = json.dumps(self.to_dict(), indent=1, allow_nan=False, ensure_ascii=False) + "\n"
        texts = {"json": content, "csv": self.to_csv(), "md": self.to_markdown()}
        for ending, text in texts.items():
            write_bytes(folder / f"leaderboard.{ending}", text.encode())


def plain(found: Estimate | None) -> list[float] | None:
    """Value and interval for JSON."""
    return None if found is None else [found.value, found.low, found.high]

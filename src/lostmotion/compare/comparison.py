"""Comparison: entries over cases and rigs, on all cores, resumable; the same for observers and for controllers."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from numbers import Integral
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from ..errors import InvalidInput
from ..io.storage.written_files import check_own, replacing
from .jobs import Job, Result, run_jobs
from .names import known_names
from .score_cache import ScoreCache, Scores
from .score_table import ScoreTable
from .whole_table import keep_whole_table

Progress = Callable[[float, str], None]
Table = TypeVar("Table", bound=ScoreTable[Any])


class Named(Protocol):
    """A case or an entry."""

    @property
    def name(self) -> str: ...


class NamedCase(Named, Protocol):
    @property
    def group(self) -> str: ...

    @property
    def quick(self) -> bool: ...


class Entry(Named, Protocol):
    @property
    def kind(self) -> str: ...


@dataclass(frozen=True)
class Comparison(Generic[Table]):
    """What is compared with what, over which cases.

    Parameters
    ----------
    subject : str
        "observers" or "controllers": the argument that chooses entries, and the key of their list in the JSON.
    cases : tuple of cases
    entries : tuple of entries
    reference : str
        The entry that always takes part.
    work : callable (Job) → Result
        One case on one rig; a function of a module, so that processes find it.
    table : type of ScoreTable
    draw : callable (table as a dict, file)
        Draws the figure.
    """

    subject: str
    cases: tuple[Any, ...]
    entries: tuple[Any, ...]
    reference: str
    work: Callable[[Job], Result]
    table: type[Table]
    draw: Callable[[Mapping[str, Any], Path], None]

    def run(
        self,
        out: Path | str | None,
        *,
        quick: bool,
        seeds: Sequence[int],
        cases: Sequence[str] | None,
        entries: Sequence[str] | None,
        workers: int | None,
        force: bool,
        progress: Progress | None,
        duration: float | None = None,
    ) -> Table:
        """All that is missing in the folder is computed; then table and figure are written.

        ``duration`` (s) is the length of each recording; None: each case has its own. The other arguments: see
        ``compare_observers``.
        """
        processes = self._processes(workers)
        chosen_cases, chosen = self._chosen_cases(cases, quick), self._chosen_entries(entries)
        folder = None if out is None else Path(out)
        names = {entry.name: entry.kind for entry in chosen}
        settings: dict[str, Any] = {"quick": quick, "part": cases is not None or entries is not None}
        if duration is not None:
            settings = {"duration": duration, **settings}
        table = self.table(names, chosen_cases, tuple(seeds), {}, settings)
        files = [] if folder is None else [folder / f"leaderboard.{e}" for e in ("md", "json", "csv", "svg")]
        if folder is not None and not force:
            keep_whole_table(
                folder, table, self.subject, [e.name for e in self.entries], [c.name for c in self.cases]
            )
        check_own(*files, force=force)
        cache = ScoreCache(folder, None if duration is None else f"duration_{duration!r}")
        jobs = list(_jobs(chosen_cases, seeds, names, cache, duration))
        report = progress or (lambda fraction, text: None)
        with closing(run_jobs(self.work, jobs, processes)) as results:
            for done, (case, seed, found) in enumerate(results, start=1):
                cache.add(case, seed, found)
                report(done / len(jobs), f"{case}, rig {seed}")
        scores = {
            case.name: {seed: _only(cache.scores(case.name, seed), names) for seed in seeds}
            for case in chosen_cases
        }
        table = replace(table, scores=scores)
        if folder is not None:
            with replacing(*files, force=force):
                table.write(folder)
                self.draw(table.to_dict(), folder / "leaderboard.svg")
        return table

    def seeds(self, given: int | Sequence[int], first: int) -> tuple[int, ...]:
        """Seeds of so many rigs, from the first on, or those given."""
        where = f"compare_{self.subject}.seeds"
        listed: Any = (
            range(first, first + int(given)) if isinstance(given, Integral) and _whole(given) else given
        )
        if not isinstance(listed, Iterable) or not all(map(_whole, listed := tuple(listed))):
            expected, remedy = "a whole number of rigs, or their whole seeds", "Give 5, or [1, 2, 7]."
            raise InvalidInput(where, repr(given), expected, remedy)
        seeds: tuple[int, ...] = tuple(int(seed) for seed in listed)
        if not seeds or len(set(seeds)) < len(seeds) or min(seeds) < 0:
            raise InvalidInput(where, repr(given), "at least one seed, each once", "Give a number.")
        return seeds

    def _processes(self, given: int | None) -> int:
        if given is None:
            return os.cpu_count() or 1
        if not _whole(given) or given < 1:
            raise InvalidInput(
                f"compare_{self.subject}.workers", repr(given), "a whole number from 1 on",
                "Leave it out for all cores.",
            )  # fmt: skip
        return int(given)

    def _chosen_cases(self, names: Sequence[str] | None, quick: bool) -> tuple[NamedCase, ...]:
        if names is None:
            return tuple(case for case in self.cases if case.quick or not quick)
        chosen = known_names(self.subject, "cases", names, [case.name for case in self.cases])
        return tuple(case for case in self.cases if case.name in chosen)

    def _chosen_entries(self, names: Sequence[str] | None) -> tuple[Entry, ...]:
        if names is None:
            return self.entries
        chosen = known_names(self.subject, self.subject, names, [entry.name for entry in self.entries])
        return tuple(entry for entry in self.entries if entry.name in {*chosen, self.reference})


def _only(found: Scores, names: Iterable[str]) -> Scores:
    return {name: found[name] for name in names if name in found}


def _jobs(
    cases: Sequence[NamedCase],
    seeds: Sequence[int],
    names: Iterable[str],
    cache: ScoreCache,
    duration: float | None,
) -> Iterator[Job]:
    """Jobs that are missing, seed by seed, so that an interrupted comparison is complete for its first rigs."""
    for seed in seeds:
        for case in cases:
            missing = tuple(name for name in names if name not in cache.scores(case.name, seed))
            if missing:
                yield case.name, seed, duration, missing


def _whole(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)

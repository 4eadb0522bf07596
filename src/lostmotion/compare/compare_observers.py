"""compare_observers: all contestants over the same recordings of the virtual rig."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from numbers import Integral, Real
from pathlib import Path

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from ..io.storage.written_files import check_own, replacing
from .cases import CASES, Case
from .contestants import CONTESTANTS, REFERENCE, Contestant
from .jobs import Job, run_jobs
from .leaderboard import Leaderboard
from .names import known_names
from .score_cache import ScoreCache, Scores
from .whole_table import keep_whole_table

Progress = Callable[[float, str], None]

#: Recordings of the full and of the quick comparison: seeds and length in s (option: the quick one takes about two
#: minutes of processor time at its first use, most of it for compiling the observers).
FULL, QUICK = (20, 3.0), (2, 1.5)


@checks_arguments
def compare_observers(
    out: Path | str | None = None,
    *,
    quick: bool = False,
    seeds: int | Sequence[int] | None = None,
    cases: Sequence[str] | None = None,
    observers: Sequence[str] | None = None,
    duration: float | None = None,
    workers: int | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> Leaderboard:
    """Compare all observers on the same recordings of the virtual rig.

    Parameters
    ----------
    out : folder, optional
        For leaderboard.json, .csv, .md and .svg, and ``scores/`` with one file per duration, case and seed. A later
        call with the same folder computes only what is missing there or was made by other code. A table of all
        observers and cases in it is not replaced by a smaller one.
    quick : bool
        Fewer cases, two seeds, shorter recordings.
    seeds : int or sequence of int, optional
        Number of rigs (1, 2, …), or their seeds. Default 20, quick 2.
    cases, observers : sequence of str, optional
        Names out of ``CASES`` and ``CONTESTANTS``, in ASCII and small letters too ("inertia_load -20 %", "hinfinity");
        default all (quick: the quick cases). Observer 1 always takes part.
    duration : float, s, optional
        Length of each recording; default 3 s, quick 1.5 s.
    workers : int, optional
        Processes; default one for each core; 1: this process alone.
    force : bool
        Replace the folder's table in any case; its scores stay.
    progress : callable (fraction, text), optional

    Returns
    -------
    Leaderboard

    Raises
    ------
    InvalidInput
        For unknown names, seeds or workers that are no whole numbers, a duration that is too short, a folder that
        cannot be written, and one that contains a larger table, or one that was changed since.
    """
    count, default = QUICK if quick else FULL
    length = _duration(default if duration is None else duration)
    processes = _processes(workers)
    chosen_seeds = _seeds(count if seeds is None else seeds)
    chosen_cases = _chosen_cases(cases, quick)
    entries = _chosen_contestants(observers)
    folder = None if out is None else Path(out)
    names = {entry.name: entry.kind for entry in entries}
    settings = {"duration": length, "quick": quick, "part": cases is not None or observers is not None}
    board = Leaderboard(names, chosen_cases, chosen_seeds, {}, settings)
    if folder is not None and not force:
        keep_whole_table(folder, board)
    if folder is not None:
        check_own(*_files(folder), force=force)
    cache = ScoreCache(folder, length)
    jobs = list(_jobs(chosen_cases, chosen_seeds, entries, cache, length))
    report = progress or (lambda fraction, text: None)
    with closing(run_jobs(jobs, processes)) as results:
        for done, (case, seed, found) in enumerate(results, start=1):
            cache.add(case, seed, found)
            report(done / len(jobs), f"{case}, rig {seed}")
    scores = {
        case.name: {s: _only(cache.scores(case.name, s), names) for s in chosen_seeds}
        for case in chosen_cases
    }
    board = replace(board, scores=scores)
    if folder is not None:
        with replacing(*_files(folder), force=force):
            board.write(folder)
            _draw(board, folder)
    return board


def _files(folder: Path) -> list[Path]:
    """What is written beside the scores."""
    return [folder / f"leaderboard.{ending}" for ending in ("md", "json", "csv", "svg")]


def _draw(board: Leaderboard, folder: Path) -> None:
    from ..plot.observers.leaderboard import leaderboard

    leaderboard(board.to_dict()).savefig(folder / "leaderboard.svg")


def _only(found: Scores, names: Iterable[str]) -> Scores:
    return {name: found[name] for name in names if name in found}


def _jobs(
    cases: Sequence[Case],
    seeds: Sequence[int],
    entries: Sequence[Contestant],
    cache: ScoreCache,
    duration: float,
) -> Iterator[Job]:
    """Jobs that are missing, seed by seed, so that an interrupted comparison is complete for its first rigs."""
    for seed in seeds:
        for case in cases:
            missing = tuple(e.name for e in entries if e.name not in cache.scores(case.name, seed))
            if missing:
                yield case.name, seed, duration, missing


def _duration(given: float) -> float:
    length = float(given) if isinstance(given, Real) and not isinstance(given, bool) else math.nan
    if not (math.isfinite(length) and length >= 1.0):
        raise InvalidInput("compare_observers.duration", repr(given), "at least 1 s", "Record longer.")
    return length


def _whole(value: object) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool)


def _processes(given: int | None) -> int:
    if given is None:
        return os.cpu_count() or 1
    if not _whole(given) or given < 1:
        raise InvalidInput(
            "compare_observers.workers",
            repr(given),
            "a whole number from 1 on",
            "Leave it out for all cores.",
        )
    return int(given)


def _seeds(given: int | Sequence[int]) -> tuple[int, ...]:
    seeds = tuple(range(1, int(given) + 1)) if isinstance(given, Integral) and _whole(given) else given
    if not isinstance(seeds, Iterable) or not all(map(_whole, seeds := tuple(seeds))):
        expected, remedy = "a whole number of rigs, or their whole seeds", "Give 5, or [1, 2, 7]."
        raise InvalidInput("compare_observers.seeds", repr(given), expected, remedy)
    if not seeds or len(set(seeds)) < len(seeds) or min(seeds) < 0:
        raise InvalidInput(
            "compare_observers.seeds", repr(given), "at least one seed, each once", "Give a number."
        )
    return tuple(int(seed) for seed in seeds)


def _chosen_cases(names: Sequence[str] | None, quick: bool) -> tuple[Case, ...]:
    if names is None:
        return tuple(case for case in CASES if case.quick or not quick)
    chosen = known_names("cases", names, [case.name for case in CASES])
    return tuple(case for case in CASES if case.name in chosen)


def _chosen_contestants(names: Sequence[str] | None) -> tuple[Contestant, ...]:
    if names is None:
        return CONTESTANTS
    chosen = known_names("observers", names, [entry.name for entry in CONTESTANTS])
    return tuple(entry for entry in CONTESTANTS if entry.name in {*chosen, REFERENCE})

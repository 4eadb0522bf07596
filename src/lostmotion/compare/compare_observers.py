"""compare_observers: all contestants over the same recordings of the virtual rig."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from ..errors import InvalidInput
from ..io.whole_files import write_bytes
from .cases import CASES, Case
from .contestants import CONTESTANTS, REFERENCE, Contestant
from .leaderboard import Leaderboard
from .scores import Score

Progress = Callable[[float, str], None]
Scores = dict[str, Score]

#: Recordings of the full and of the quick comparison: seeds and length in s (chosen: the quick one takes seconds).
FULL, QUICK = (20, 3.0), (2, 1.5)
#: Raised whenever cached scores mean something else than before.
CACHE_VERSION = 1


def compare_observers(
    out: Path | str | None = None,
    *,
    quick: bool = False,
    seeds: int | Sequence[int] | None = None,
    cases: Sequence[str] | None = None,
    observers: Sequence[str] | None = None,
    duration: float | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> Leaderboard:
    """Compare all observers on the same recordings of the virtual rig.

    Parameters
    ----------
    out : folder, optional
        Gets leaderboard.json, .csv, .md and .svg, and ``scores/`` with one file per case and seed. A later call
        with the same folder computes only what is missing there: delete ``scores/`` after a change of the code.
    quick : bool
        Fewer cases, two seeds, shorter recordings, no slow observers.
    seeds : int or sequence of int, optional
        Number of rigs (1, 2, …), or their seeds. Default 20, quick 2.
    cases, observers : sequence of str, optional
        Names out of ``CASES`` and ``CONTESTANTS``; default all (quick: the quick ones). Observer 1 always takes part.
    duration : float, s, optional
        Length of each recording; default 3 s, quick 1.5 s.
    workers : int, optional
        Processes; default one for each core; 1: none but this one.
    progress : callable (fraction, text), optional

    Returns
    -------
    Leaderboard

    Raises
    ------
    InvalidInput
        For unknown names, and for a duration that is too short to judge.
    """
    count, length = QUICK if quick else FULL
    length = length if duration is None else float(duration)
    if not (math.isfinite(length) and length >= 1.0):
        raise InvalidInput("compare_observers.duration", repr(duration), "at least 1 s", "Record longer.")
    chosen_seeds = _seeds(count if seeds is None else seeds)
    chosen_cases = _chosen_cases(cases, quick)
    entries = _chosen_contestants(observers, quick)
    folder = None if out is None else _folder(Path(out))
    cache = _Cache(folder, {"version": CACHE_VERSION, "duration": length})
    jobs = list(_jobs(chosen_cases, chosen_seeds, entries, cache, length))
    report = progress or (lambda fraction, text: None)
    for done, (case, seed, found) in enumerate(_results(jobs, workers or os.cpu_count() or 1), start=1):
        cache.add(case, seed, found)
        report(done / len(jobs), f"{case}, rig {seed}")
    names = {entry.name: entry.kind for entry in entries}
    board = Leaderboard(
        observers=names,
        cases=chosen_cases,
        seeds=chosen_seeds,
        scores={
            case.name: {s: _only(cache.scores(case.name, s), names) for s in chosen_seeds}
            for case in chosen_cases
        },
        settings={"duration": length, "quick": quick},
    )
    if folder is not None:
        board.write(folder)
        _draw(board, folder)
    return board


def _draw(board: Leaderboard, folder: Path) -> None:
    from ..plot.leaderboard import leaderboard

    leaderboard(board.to_dict()).savefig(folder / "leaderboard.svg")


def _only(found: Scores, names: Iterable[str]) -> Scores:
    return {name: found[name] for name in names if name in found}


def _seeds(given: int | Sequence[int]) -> tuple[int, ...]:
    seeds = tuple(range(1, given + 1)) if isinstance(given, int) else tuple(given)
    if not seeds or len(set(seeds)) < len(seeds) or min(seeds) < 0:
        raise InvalidInput(
            "compare_observers.seeds", repr(given), "at least one seed, each once", "Give a number."
        )
    return seeds


def _chosen_cases(names: Sequence[str] | None, quick: bool) -> tuple[Case, ...]:
    known = {case.name: case for case in CASES}
    if names is None:
        return tuple(case for case in CASES if case.quick or not quick)
    _check_known("cases", names, known)
    return tuple(case for case in CASES if case.name in names)


def _chosen_contestants(names: Sequence[str] | None, quick: bool) -> tuple[Contestant, ...]:
    known = {entry.name for entry in CONTESTANTS}
    if names is None:
        return tuple(entry for entry in CONTESTANTS if not (quick and entry.slow))
    _check_known("observers", names, known)
    return tuple(entry for entry in CONTESTANTS if entry.name in {*names, REFERENCE})


def _check_known(what: str, names: Sequence[str], known: Iterable[str]) -> None:
    unknown = sorted(set(names) - set(known))
    if unknown or not names:
        raise InvalidInput(
            f"compare_observers.{what}", f"{unknown}", f"names out of {sorted(known)}", "Check."
        )


def _folder(path: Path) -> Path:
    try:
        (path / "scores").mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InvalidInput(
            str(path), str(error.strerror or error), "a folder that can be written", "Check."
        ) from None
    return path


class _Cache:
    """Scores per case and seed, kept in files if there is a folder."""

    def __init__(self, folder: Path | None, settings: dict[str, Any]) -> None:
        self.folder = None if folder is None else folder / "scores"
        self.settings = settings
        self._found: dict[tuple[str, int], Scores] = {}

    def scores(self, case: str, seed: int) -> Scores:
        if (case, seed) not in self._found:
            self._found[case, seed] = self._read(case, seed)
        return self._found[case, seed]

    def add(self, case: str, seed: int, found: Scores) -> None:
        self._found[case, seed] = {**self.scores(case, seed), **found}
        if self.folder is not None:
            content = {
                "settings": self.settings,
                "case": case,
                "seed": seed,
                "scores": self._found[case, seed],
            }
            write_bytes(self._path(case, seed), json.dumps(content, indent=1, allow_nan=False).encode())

    def _path(self, case: str, seed: int) -> Path:
        words = "".join(c if c.isalnum() or c in "+−." else "_" for c in case)
        return (self.folder or Path()) / f"{words}__{seed}.json"

    def _read(self, case: str, seed: int) -> Scores:
        """The file's scores; a file that is torn or belongs to other settings counts as none."""
        if self.folder is None or not self._path(case, seed).is_file():
            return {}
        try:
            content = json.loads(self._path(case, seed).read_text())
            return dict(content["scores"]) if content["settings"] == self.settings else {}
        except (ValueError, KeyError, TypeError):
            return {}


Job = tuple[str, int, float, tuple[str, ...]]


def _jobs(
    cases: Sequence[Case], seeds: Sequence[int], entries: Sequence[Contestant], cache: _Cache, duration: float
) -> Iterator[Job]:
    """What is missing, seed by seed, so that an interrupted comparison is complete for its first rigs."""
    for seed in seeds:
        for case in cases:
            missing = tuple(e.name for e in entries if e.name not in cache.scores(case.name, seed))
            if missing:
                yield case.name, seed, duration, missing


def _results(jobs: Sequence[Job], workers: int) -> Iterator[tuple[str, int, Scores]]:
    if workers == 1 or len(jobs) < 2:
        yield from map(run_job, jobs)
        return
    with ProcessPoolExecutor(min(workers, len(jobs))) as pool:
        futures = [pool.submit(run_job, job) for job in jobs]
        try:
            for future in as_completed(futures):
                yield future.result()
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def run_job(job: Job) -> tuple[str, int, Scores]:
    """One case on one rig for the named observers; runs in a process of its own."""
    from .experiment import experiment
    from .scores import score

    name, seed, duration, names = job
    case = next(c for c in CASES if c.name == name)
    data = experiment(case, seed, duration)
    entries = {entry.name: entry for entry in CONTESTANTS}
    return name, seed, {n: score(entries[n].make(data.drivetrain, data.sensing), data) for n in names}

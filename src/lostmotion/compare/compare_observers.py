"""compare_observers: all contestants over the same recordings of the virtual rig."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from pathlib import Path
from typing import Any

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .cases import CASES
from .comparison import Comparison, Progress
from .contestants import CONTESTANTS, REFERENCE
from .leaderboard import Leaderboard
from .score_observers import score_observers

#: First seed of the table, which nothing was tuned on: observers are tuned on rigs 1 to 40 (option).
FIRST_SEED = 501
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
    """Compare all observers on the same recordings of the virtual rig and of drives of the zoo.

    Parameters
    ----------
    out : folder, optional
        For leaderboard.json, .csv, .md and .svg, and ``scores/`` with one file per duration, case and seed. A later
        call with the same folder computes only what is missing there or was made by other code. A table of all
        observers and cases in it is not replaced by a smaller one.
    quick : bool
        Fewer cases, two seeds, shorter recordings.
    seeds : int or sequence of int, optional
        Number of rigs (501, 502, …), or their seeds; each has drives of the zoo of its own. Default 20, quick 2.
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
    return OBSERVERS.run(
        out, quick=quick, seeds=OBSERVERS.seeds(count if seeds is None else seeds, FIRST_SEED), cases=cases,
        entries=observers, workers=workers, force=force, progress=progress,
        duration=_duration(default if duration is None else duration),
    )  # fmt: skip


def _draw(board: Mapping[str, Any], file: Path) -> None:
    from ..plot.observers.leaderboard import leaderboard

    leaderboard(board).savefig(file)


#: What is compared here.
OBSERVERS = Comparison("observers", CASES, CONTESTANTS, REFERENCE, score_observers, Leaderboard, _draw)


def _duration(given: float) -> float:
    length = float(given) if isinstance(given, Real) and not isinstance(given, bool) else math.nan
    if not (math.isfinite(length) and length >= 1.0):
        raise InvalidInput("compare_observers.duration", repr(given), "at least 1 s", "Record longer.")
    return length

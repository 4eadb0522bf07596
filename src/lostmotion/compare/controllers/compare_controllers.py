"""compare_controllers: all laws in the loop of the same virtual rigs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..comparison import Comparison, Progress
from .cases import CASES
from .contestants import CONTESTANTS, REFERENCE
from .leaderboard import ControlTable
from .score_controllers import score_controllers

#: First seed of the table, which nothing was tuned on: laws are tuned on 1 to 40 (option).
FIRST_SEED = 401
#: Rigs of the full and of the quick comparison (option).
FULL, QUICK = 20, 2


def compare_controllers(
    out: Path | str | None = None,
    *,
    quick: bool = False,
    seeds: int | Sequence[int] | None = None,
    cases: Sequence[str] | None = None,
    controllers: Sequence[str] | None = None,
    workers: int | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> ControlTable:
    """Compare all control laws on the same virtual rigs, each designed on the drivetrain identified there.

    Parameters
    ----------
    out : folder, optional
        For leaderboard.json, .csv, .md and .svg, and ``scores/`` with one file per case and seed. A later call with the
        same folder computes only what is missing there or was made by other code.
    quick : bool
        Fewer cases, two rigs.
    seeds : int or sequence of int, optional
        Number of rigs (401, 402, …), or their seeds. Default 20, quick 2.
    cases, controllers : sequence of str, optional
        Names; default all (quick: the quick cases). Pole placement always takes part.
    workers, force, progress
        As in ``compare_observers``.

    Returns
    -------
    ControlTable

    Raises
    ------
    InvalidInput
        As ``compare_observers``.
    """
    given = (QUICK if quick else FULL) if seeds is None else seeds
    return CONTROLLERS.run(
        out, quick=quick, seeds=CONTROLLERS.seeds(given, FIRST_SEED), cases=cases, entries=controllers,
        workers=workers, force=force, progress=progress,
    )  # fmt: skip


def _draw(table: Mapping[str, Any], file: Path) -> None:
    from ...plot.controllers.leaderboard import controller_leaderboard

    controller_leaderboard(table).savefig(file)


#: What is compared here.
CONTROLLERS = Comparison("controllers", CASES, CONTESTANTS, REFERENCE, score_controllers, ControlTable, _draw)

"""Leaderboards as commands."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..display.tables import aligned
from .compiling import compile_kernels
from .messages import finished, interruptible, say

if TYPE_CHECKING:
    from ..compare.score_table import ScoreTable


def _list_observers(wanted: bool) -> None:
    if wanted:
        from ..compare import CASES, CONTESTANTS

        _list_names({"Cases": CASES, "Observers": CONTESTANTS})


def _list_controllers(wanted: bool) -> None:
    if wanted:
        from ..compare.controllers import CASES, CONTESTANTS

        _list_names({"Cases": CASES, "Controllers": CONTESTANTS})


def _list_names(lists: Mapping[str, Sequence[Any]]) -> None:
    for what, entries in lists.items():
        typer.echo("\n  ".join([f"{what}:", *(entry.name for entry in entries)]))
    raise typer.Exit


Seeds = Annotated[int | None, typer.Option(min=1, help="Number of rigs; default 20, quick 2.")]
Cases = Annotated[list[str] | None, typer.Option(help="A case by its name (see --list); repeat it for more.")]
Force = Annotated[
    bool,
    typer.Option(
        "--force", help="Replace a larger table in the folder, or one that was changed; its scores are kept."
    ),
]


def observers(
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the leaderboard; finished parts are kept. "
            "Default: leaderboard, with --quick leaderboard-quick, with --case or --observer leaderboard-part."
        ),
    ] = None,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help="Two rigs, fewer cases, short recordings: two minutes of processor time at first.",
        ),
    ] = False,
    seeds: Seeds = None,
    case: Cases = None,
    observer: Annotated[
        list[str] | None, typer.Option(help="An observer by its name (see --list); repeat it for more.")
    ] = None,
    force: Force = False,
    names: Annotated[
        bool,
        typer.Option(
            "--list", is_eager=True, callback=_list_observers, help="List cases and observers, and stop."
        ),
    ] = False,
) -> None:
    """All observers over the same recordings of the virtual rig, as a leaderboard."""
    from ..compare import compare_observers

    out = out or _folder("leaderboard", quick, bool(case or observer))
    _compare(
        out, ("simulation", "identification", "observers"), lambda progress: compare_observers(
            out, quick=quick, seeds=seeds, cases=case or None, observers=observer or None, force=force,
            progress=progress,
        )
    )  # fmt: skip


def controllers(
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the leaderboard; finished parts are kept. "
            "Default: controllers, with --quick controllers-quick, with --case or --controller controllers-part."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Two rigs, fewer cases.")] = False,
    seeds: Seeds = None,
    case: Cases = None,
    controller: Annotated[
        list[str] | None, typer.Option(help="A law by its name (see --list); repeat it for more.")
    ] = None,
    force: Force = False,
    names: Annotated[
        bool,
        typer.Option(
            "--list", is_eager=True, callback=_list_controllers, help="List cases and laws, and stop."
        ),
    ] = False,
) -> None:
    """All control laws in the loop of the same virtual rigs, as a leaderboard."""
    from ..compare import compare_controllers

    out = out or _folder("controllers", quick, bool(case or controller))
    _compare(
        out, ("simulation", "identification"), lambda progress: compare_controllers(
            out, quick=quick, seeds=seeds, cases=case or None, controllers=controller or None, force=force,
            progress=progress,
        )
    )  # fmt: skip


def _folder(name: str, quick: bool, part: bool) -> Path:
    return Path(f"{name}-part" if part else f"{name}-quick" if quick else name)


def _compare(
    out: Path, kernels: Sequence[str], work: Callable[[Callable[[float, str], None]], ScoreTable[Any]]
) -> None:
    """Runs a comparison, which needs those parts of the kernels, with a line of progress, and prints its table."""
    from ..terminal import StageLines

    compile_kernels(*kernels)
    with interruptible("finished parts", out / "scores", "*.json"), StageLines(every=0.1) as lines:
        lines("compare", 0.0)
        table = work(lambda fraction, text: lines("compare", fraction, text))
        lines("compare", 1.0)
    shown = table.to_markdown()
    say(aligned(shown) if sys.stdout.isatty() else shown)
    finished([], out, *(f"/leaderboard.{ending}" for ending in ("md", "json", "csv", "svg")))

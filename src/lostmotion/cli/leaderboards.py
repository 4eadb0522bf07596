"""Leaderboards as commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .compiling import compile_kernels
from .messages import finished, interruptible


def _list_names(wanted: bool) -> None:
    if wanted:
        from ..compare import CASES, CONTESTANTS

        for what, entries in (("Cases", CASES), ("Observers", CONTESTANTS)):
            typer.echo("\n  ".join([f"{what}:", *(entry.name for entry in entries)]))
        raise typer.Exit


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
            help="Two seeds, fewer cases, short recordings: two minutes of processor time at first.",
        ),
    ] = False,
    seeds: Annotated[int | None, typer.Option(min=1, help="Number of rigs; default 20, quick 2.")] = None,
    case: Annotated[
        list[str] | None, typer.Option(help="A case by its name (see --list); repeat it for more.")
    ] = None,
    observer: Annotated[
        list[str] | None, typer.Option(help="An observer by its name (see --list); repeat it for more.")
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force",
            help="Replace a larger table in the folder, or one that was changed; its scores are kept.",
        ),
    ] = False,
    names: Annotated[
        bool,
        typer.Option(
            "--list", is_eager=True, callback=_list_names, help="List cases and observers, and stop."
        ),
    ] = False,
) -> None:
    """All observers over the same recordings of the virtual rig, as a leaderboard."""
    from ..terminal import StageLines

    compile_kernels("simulation", "identification", "observers")
    part = bool(case or observer)
    out = out or Path("leaderboard-part" if part else "leaderboard-quick" if quick else "leaderboard")
    with interruptible("finished parts", out / "scores", "*.json"), StageLines(every=0.1) as lines:
        from ..compare import compare_observers

        lines("compare", 0.0)
        board = compare_observers(
            out, quick=quick, seeds=seeds, cases=case or None, observers=observer or None, force=force,
            progress=lambda fraction, text: lines("compare", fraction, text),
        )  # fmt: skip
        lines("compare", 1.0)
    typer.echo(board.to_markdown())
    finished([], out, *(f"/leaderboard.{ending}" for ending in ("md", "json", "csv", "svg")))

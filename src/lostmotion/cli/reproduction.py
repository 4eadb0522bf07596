"""The paper, reproduced, as a command."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from .compiling import compile_kernels
from .messages import interruptible


def paper(
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("lostmotion-paper"),
    quick: Annotated[
        bool,
        typer.Option("--quick", help="A quarter of the random torque, no proof for a box: half a minute."),
    ] = False,
    force: Annotated[
        bool,
        typer.Option("--force", help="Write even if the folder has foreign or changed files; they are kept."),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show errors only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print claims.json.")] = False,
) -> None:
    """Fietzek & Rinderknecht on the virtual rig: every figure, table and claim, and the outlook answered."""
    from ..paper import reproduce
    from ..paper.reproduce import silent
    from ..terminal import StageLines, claims

    shown = not (quiet or as_json)
    compile_kernels("simulation", "identification", "observers", shown=shown)
    with interruptible(), StageLines(shown=shown) as lines:
        content = reproduce(out, quick=quick, force=force, progress=lines if lines.shown else silent)
    if as_json:
        typer.echo(json.dumps(content, indent=1, allow_nan=False))
    elif not quiet:
        claims(content, out)

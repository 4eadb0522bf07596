"""The main job as a command, and how its TOML comes about."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated

import typer

from ..errors import InvalidInput
from .compiling import compile_kernels
from .messages import INPUT_ERROR, interruptible, show

#: What ``init --schema`` writes beside the TOML.
SCHEMA_FILE = "lostmotion.schema.json"


def run(
    file: Annotated[
        Path | None, typer.Argument(help="TOML with your recordings; without: the virtual rig.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("lostmotion-out"),
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of rig and noise; default: the TOML's, else 1.")
    ] = None,
    force: Annotated[
        bool,
        typer.Option("--force", help="Write even if the folder has foreign or changed files; they are kept."),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show errors only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print results.json.")] = False,
) -> None:
    """The main job: read, identify, design, validate, export, report."""
    from ..run import run as do_run
    from ..run import silent
    from ..terminal import StageLines, summary

    shown = not (quiet or as_json)
    compile_kernels("simulation", "identification", shown=shown)
    with interruptible(), StageLines(shown=shown) as lines:
        results = do_run(file, out=out, seed=seed, force=force, progress=lines if lines.shown else silent)
    if as_json:
        typer.echo(json.dumps(results, indent=1, allow_nan=False))
    elif not quiet:
        summary(results, out)


def check(
    file: Annotated[Path, typer.Argument(help="TOML to check, with all its recordings.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the problems as JSON.")] = False,
) -> None:
    """Read a TOML and its recordings and show every problem; nothing is written."""
    from ..io import find_problems

    problems = list(find_problems(file))
    failed = any(p.severity == "error" for p in problems)
    if as_json:
        typer.echo(json.dumps([p.as_dict() for p in problems], indent=1))
    else:
        show(problems)
        if not failed:
            typer.echo(f"{file}: readable, {len(problems)} warning{'' if len(problems) == 1 else 's'}.")
    raise typer.Exit(INPUT_ERROR if failed else 0)


def init(
    file: Annotated[Path, typer.Argument(help="TOML to write.")] = Path("my_rig.toml"),
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
    schema: Annotated[
        bool, typer.Option("--schema", help=f"Write {SCHEMA_FILE} beside it, for editors that complete keys.")
    ] = False,
) -> None:
    """Write a commented TOML to fill in."""
    from ..io import configuration_schema, template
    from ..io.storage.whole_files import write_bytes

    texts = {file: template()}
    if schema:
        beside = file.with_name(SCHEMA_FILE)
        texts = {
            beside: json.dumps(configuration_schema(), indent=1, ensure_ascii=False) + "\n",
            file: f"#:schema ./{SCHEMA_FILE}\n{template()}",
        }
    for path in texts:
        if os.path.lexists(path) and not force:
            raise InvalidInput(
                str(path), "an existing file", "a new name", "Choose another name, or --force."
            )
    with interruptible():
        for path, text in texts.items():
            write_bytes(path, text.encode("utf-8"))
    typer.echo(f"{file} written: fill it in, then: lostmotion check {file}")

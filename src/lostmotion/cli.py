"""The command line: each command is a few lines around a function of the package."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from . import __version__
from .errors import InputProblems, LostMotionError, Problem

EXIT_CODES = (
    "Exit codes: 0 done (warnings included), 1 the input or the output folder has errors and nothing was written, "
    "2 wrong usage, 130 interrupted; an earlier output stays whole in all cases but 0."
)
INPUT_ERROR, INTERRUPTED = 1, 130

app = typer.Typer(
    help="From a recording to an identified drivetrain with backlash, observer, controller, evidence and C code.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"lostmotion {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and stop."),
    ] = False,
) -> None:
    pass


@app.command(epilog=EXIT_CODES)
def run(
    file: Annotated[
        Path | None, typer.Argument(help="TOML with your recordings; without: the virtual rig.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("lostmotion-out"),
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of rig and noise; default: the TOML's, else 1.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write although foreign files lie in the folder.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show errors only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print results.json.")] = False,
) -> None:
    """The main job: read, identify, design, validate, export, report."""
    from .run import run as do_run
    from .run import silent
    from .terminal import StageLines, summary

    with _interruptible(), StageLines(shown=not (quiet or as_json)) as lines:
        results = do_run(file, out=out, seed=seed, force=force, progress=lines if lines.shown else silent)
    if as_json:
        typer.echo(json.dumps(results, indent=1, allow_nan=False))
    elif not quiet:
        summary(results, out)


@app.command(epilog=EXIT_CODES)
def check(
    file: Annotated[Path, typer.Argument(help="TOML to check, with all its recordings.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the problems as JSON.")] = False,
) -> None:
    """Read a TOML and its recordings and show every problem; nothing is written."""
    from .io import load_recordings, read_configuration

    problems: list[Problem] = []
    try:
        loaded = load_recordings(read_configuration(file))
        problems += [p for _, recording in loaded for p in recording.meta.get("problems", ())]
    except InputProblems as error:
        problems += error.problems
    failed = any(p.severity == "error" for p in problems)
    if as_json:
        typer.echo(json.dumps([p.as_dict() for p in problems], indent=1))
    else:
        _show(problems)
        if not failed:
            typer.echo(f"{file}: readable, {len(problems)} warning{'' if len(problems) == 1 else 's'}.")
    raise typer.Exit(INPUT_ERROR if failed else 0)


@app.command(epilog=EXIT_CODES)
def init(
    file: Annotated[Path, typer.Argument(help="TOML to write.")] = Path("my_rig.toml"),
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Write a commented TOML to fill in."""
    from .errors import InvalidInput
    from .io import template

    if file.exists() and not force:
        raise InvalidInput(str(file), "an existing file", "a new name", "Choose another name, or --force.")
    try:
        file.write_text(template(), encoding="utf-8")
    except OSError as error:
        raise InvalidInput(
            str(file), error.strerror or "an error", "a place to write", "Choose another."
        ) from None
    typer.echo(f"{file} written: fill it in, then: lostmotion check {file}")


@contextmanager
def _interruptible() -> Iterator[None]:
    """Ctrl-C becomes a message and an exit code (typer itself would end without a word)."""
    try:
        yield
    except KeyboardInterrupt:
        typer.secho("Interrupted; an earlier output is as it was.", fg="yellow", err=True)
        raise typer.Exit(INTERRUPTED) from None


def _show(problems: list[Problem]) -> None:
    for p in problems:
        typer.secho(f"{p.severity}: {p.where}", fg="red" if p.severity == "error" else "yellow", err=True)
        typer.echo(f"    got       {p.got}\n    expected  {p.expected}\n    remedy    {p.remedy}", err=True)


def main() -> None:
    """Entry point: every error of the package becomes a message and an exit code."""
    try:
        app()
    except InputProblems as error:
        _show(list(error.problems))
        sys.exit(INPUT_ERROR)
    except LostMotionError as error:
        problem = getattr(error, "problem", None)
        if isinstance(problem, Problem):
            _show([problem])
        else:
            typer.secho(f"error: {error}", fg="red", err=True)
        sys.exit(INPUT_ERROR)



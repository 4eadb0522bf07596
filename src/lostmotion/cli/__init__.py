"""The command line: each command is a few lines around a function of the package."""

from __future__ import annotations

import os
import sys
from typing import Annotated

import typer

from .. import __version__
from ..errors import InputProblems, LostMotionError, Problem
from .leaderboards import controllers, observers
from .main_job import check, init, run
from .messages import INPUT_ERROR, say, show
from .proofs import certify
from .real_time import loop
from .reproduction import paper
from .single_steps import excite, frf, identify, simulate

EXIT_CODES = (
    "Exit codes: 0 done, perhaps with warnings; 1 error in the input, or the output cannot be written; "
    "2 wrong usage; 130 interrupted."
)
RUN_EXIT_CODES = f"{EXIT_CODES} Unless it is 0, nothing was written, and an earlier output is unchanged."


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"lostmotion {__version__}")
        raise typer.Exit


def _limit_memory(size: str | None) -> None:
    """For this process and those that it starts."""
    if size is not None:
        from ..memory import VARIABLE, parse_size

        parse_size(size, "--memory-limit")
        os.environ[VARIABLE] = size


def _options(
    memory_limit: Annotated[
        str | None,
        typer.Option(
            callback=_limit_memory,
            metavar="SIZE",
            help='Memory for a file or a simulation, such as "4GB"; default: 1GB, or LOSTMOTION_MEMORY_LIMIT.',
        ),
    ] = None,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and stop."),
    ] = False,
) -> None:
    pass


app = typer.Typer(
    help="From a recording to an identified drivetrain with backlash, observer, controller, report and C code.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)
app.callback()(_options)
app.command(epilog=RUN_EXIT_CODES)(run)
for command in (check, init, identify, frf, excite, simulate, certify, paper, loop):
    app.command(epilog=EXIT_CODES)(command)

compare_app = typer.Typer(help="Leaderboards.", no_args_is_help=True)
for comparison in (observers, controllers):
    compare_app.command(epilog=EXIT_CODES)(comparison)
app.add_typer(compare_app, name="compare")


def main() -> None:
    """Entry point: every error of the package becomes a message and an exit code."""
    try:
        app()
    except InputProblems as error:
        show(list(error.problems))
        sys.exit(INPUT_ERROR)
    except LostMotionError as error:
        problem = getattr(error, "problem", None)
        if isinstance(problem, Problem):
            show([problem])
        else:
            say(f"error: {error}", fg="red", err=True)
        sys.exit(INPUT_ERROR)

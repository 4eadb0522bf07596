"""What every command says in the same way: problems, files written, an interruption."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import typer

from ..display.wrapping import wrapped
from ..errors import Problem
from ..interruption import INTERRUPTED, as_exceptions

#: Exit code (option).
INPUT_ERROR = 1


def say(text: str, *, fg: str | None = None, err: bool = False) -> None:
    """Text for a person; a terminal gets lines of its width.

    By ``print``, not ``typer.echo``: a progress display that is on makes room for what is printed.
    """
    stream = sys.stderr if err else sys.stdout
    shown = wrapped(text, stream)
    coloured = fg is not None and stream is not None and stream.isatty()
    print(typer.style(shown, fg=fg) if coloured else shown, file=stream)


def announce(sentence: str) -> None:
    """What a command will cost, on standard error."""
    say(f"  {sentence}", fg="yellow", err=True)


def finished(problems: list[dict[str, str]], out: Path, *endings: str) -> None:
    """Warnings on standard error, then the files written: in a folder (``/…``), or of one name with several endings."""
    from ..commands.outputs import stem

    show([Problem(**p) for p in problems])  # type: ignore[arg-type]
    say("  written: " + ", ".join(f"{out if ending[0] == '/' else stem(out)}{ending}" for ending in endings))


@contextmanager
def interruptible(parts: str = "", folder: Path | None = None, files: str = "*") -> Iterator[None]:
    """Around what writes: Ctrl-C becomes a message and an exit code, SIGTERM an exit code, and nothing hidden stays.

    ``parts`` are what the command goes on from: ``files`` in the folder, where there are any by then.
    """
    try:
        with as_exceptions():
            yield
    except KeyboardInterrupt:
        kept = "an earlier output is unchanged"
        if folder is not None and any(folder.rglob(files)):
            kept = f"{parts} are kept in {folder}, the same command continues"
        say(f"Interrupted; {kept}.", fg="yellow", err=True)
        raise typer.Exit(INTERRUPTED) from None


def show(problems: list[Problem]) -> None:
    for p in problems:
        say(f"{p.severity}: {p.where}", fg="red" if p.severity == "error" else "yellow", err=True)
        say(f"    got       {p.got}\n    expected  {p.expected}\n    remedy    {p.remedy}", err=True)

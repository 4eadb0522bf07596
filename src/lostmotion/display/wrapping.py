"""Lines that a terminal is too narrow for, broken at words."""

from __future__ import annotations

import shutil
import textwrap
from typing import TextIO

#: A broken line goes on so many columns further in (option).
HANGING = 4


def wrapped(text: str, stream: TextIO | None) -> str:
    """The text for a stream: a terminal breaks long lines at words, what is no terminal gets them as they are."""
    if stream is None or not stream.isatty():
        return text
    width = shutil.get_terminal_size().columns
    return "\n".join(_broken(line, width) for line in text.split("\n"))


def _broken(line: str, width: int) -> str:
    if len(line) <= width:
        return line
    indent = " " * (len(line) - len(line.lstrip()) + HANGING)
    # A path stays whole, so that it can be copied.
    return textwrap.fill(
        line, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )

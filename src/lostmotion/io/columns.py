"""What every reader of a table gives: columns found by name or number, with their unit and their place."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..errors import Problem

_BRACKETED = re.compile(r"\s*(.*?)\s*[\[(]\s*([^\[\]()]*?)\s*[\])]\s*")


@dataclass(frozen=True, eq=False)
class Column:
    """One column of a file as it stands there.

    Parameters
    ----------
    values : (n,) array
    unit : str
        What the file says, "" if nothing.
    label : str
        Its place in the file, for errors.
    lines : (n,) array of int, optional
        Line of each value, for errors; without it the rows are counted from 0.
    """

    values: NDArray[np.float64]
    unit: str
    label: str
    lines: NDArray[np.int64] | None = None

    def place(self, row: int) -> str:
        """``line 17`` of a text file, ``row 16`` of an array."""
        return f"row {row}" if self.lines is None else f"line {self.lines[row]}"


class Table(Protocol):
    """A file whose columns are found by a key: header name, number or path."""

    def columns(self, keys: dict[str, str | int]) -> tuple[dict[str, Column], list[Problem]]:
        """The columns asked for, by the name under which they were asked for, and all problems with them."""

    def known_signals(self) -> dict[str, str | int]:
        """Keys of the columns that bear the name of a signal, and of the time under ``"time"``."""

    def time_of(self, key: str | int) -> str | int | None:
        """Key of the time that goes with a column, None if the file does not say."""


def split_unit(text: str) -> tuple[str, str]:
    """``"Speed [rpm]"`` → ``("Speed", "rpm")``; round brackets count too; without brackets the unit is ""."""
    match = _BRACKETED.fullmatch(text)
    return (match[1], match[2]) if match else (text.strip(), "")


def suggestion(key: str, known: Iterable[str]) -> str:
    """The remedy for a misspelt name: the names closest to it."""
    by_lower_case: dict[str, str] = {}
    for name in known:
        by_lower_case.setdefault(name.lower(), name)
        by_lower_case.setdefault(split_unit(name)[0].lower(), name)
    close = difflib.get_close_matches(key.lower(), by_lower_case, n=3)
    names = list(dict.fromkeys(by_lower_case[c] for c in close))
    if names:
        return "Did you mean " + " or ".join(repr(n) for n in names) + "?"
    return "Check the name against the list."


def short_list(items: Iterable[object], limit: int = 12) -> str:
    """Items separated by commas, cut after a dozen."""
    texts = [str(item) for item in items]
    more = f", … ({len(texts)} in all)" if len(texts) > limit else ""
    return ", ".join(texts[:limit]) + more

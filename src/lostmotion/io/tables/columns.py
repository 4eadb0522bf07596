"""What every reader of a table gives: columns found by name or number, with their unit and their place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...errors import Problem


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

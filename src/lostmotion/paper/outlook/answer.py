"""A question that the paper leaves open, and its answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..figures import PaperFigure


@dataclass(frozen=True)
class Table:
    """Head and rows, as text."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, eq=False)
class Answer:
    """One paragraph, a figure or numbers, and where to read on.

    Parameters
    ----------
    question : str
    text : str
    page : str
        Of the documentation, relative to its folder.
    numbers : mapping of what → number
        With their units in the names.
    figure : PaperFigure, optional
    table : Table, optional
    """

    question: str
    text: str
    page: str
    numbers: Mapping[str, float | None]
    figure: PaperFigure | None = None
    table: Table | None = None

    def as_dict(self) -> dict[str, Any]:
        """Without figure and table, for JSON."""
        return {
            "question": self.question,
            "text": self.text,
            "page": self.page,
            "numbers": dict(self.numbers),
        }

"""The table of parameters: name, value, unit, 95 % interval, half its width, source.

A table is a mapping of name → {"value", "low", "high", "unit", "source"}, as in ``results.json``: SI; value, low and
high are None where there is none.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import tables
from .numbers import NONE, half_width, rounded

Table = Mapping[str, Mapping[str, Any]]

HEADER = ("", "value", "unit", "95 % interval", "", "source")


def rows(table: Table) -> list[tuple[str, ...]]:
    """The cells of a table in the columns of ``HEADER``: no prefixes, so that value and unit are those of the table."""
    return [(name, *_cells(entry)) for name, entry in table.items()]


def text(table: Table) -> str:
    """The table in aligned columns, a line for each parameter; "" for none."""
    return tables.text(rows(table)) if table else ""


def short(table: Table) -> list[str]:
    """Name, value and unit of each parameter; of one without a value, its source instead."""
    shown = []
    for name, value, unit, *_, source in rows(table):
        shown.append(f"{name} {source}" if value == NONE else f"{name} {value} {unit}".rstrip())
    return shown


def _cells(entry: Mapping[str, Any]) -> tuple[str, ...]:
    value, low, high = (entry[key] for key in ("value", "low", "high"))
    middle, left, right = rounded(value, low, high)
    half = half_width(value, low, high)
    interval = "" if left == NONE else f"{left} … {right}"
    unit = "" if entry["unit"] == "1" else entry["unit"]
    return middle, unit, interval, "" if half == NONE else half, entry["source"]

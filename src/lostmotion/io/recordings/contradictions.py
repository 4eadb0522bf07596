"""What a file and the TOML say of it cannot both be true: the wrong columns, or the wrong sample time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...errors import Problem
from ..tables.columns import Column, Table
from ..tables.units import is_unit, unit_factor
from .checks import RASTER_TOLERANCE

#: Numbers in a second of a time without a unit: s, ms, µs, ns (physics).
_TIME_FACTORS = (1.0, 1e3, 1e6, 1e9)


def one_column_for_two(columns: Mapping[str, Column], where: str) -> list[Problem]:
    """The errors that two signals, or a signal and the time, have the same numbers; constant ones may."""
    problems: list[Problem] = []
    names = list(columns)
    for i, name in enumerate(names):
        for other in names[:i]:
            one, two = columns[other], columns[name]
            if one.label == two.label or _alike(one, two):
                problems.append(
                    Problem(
                        "error",
                        f"{where}, {other} and {name}",
                        f"the same numbers for both ({one.label}, {two.label})",
                        "a column of its own for each",
                        "Correct column of one of them, or leave it out.",
                    )
                )
    return problems


def _alike(one: Column, two: Column) -> bool:
    changes = one.values.size > 0 and bool(np.any(one.values != one.values[0]))
    return changes and np.array_equal(one.values, two.values)


def two_sample_times(table: Table, step: float, key: str | int, where: str) -> list[Problem]:
    """The error that the file has a time of its own whose steps are not the stated sample time (s).

    ``key`` is that of any channel. A time that is damaged says nothing.
    """
    time = table.known_signals().get("time", table.time_of(key))
    found, problems = ({}, []) if time is None else table.columns({"time": time})
    if problems or "time" not in found or found["time"].values.size < 2:
        return []
    column = found["time"]
    own = float(column.values[-1] - column.values[0]) / (column.values.size - 1)
    if not (np.isfinite(own) and own > 0.0) or _may_be(own, step, column.unit, where):
        return []
    return [
        Problem(
            "error",
            f"{where}, time.sample_time",
            f"{step:g} s in a file whose own time ({column.label}) has steps of {own:g} {column.unit}".rstrip(),
            "the same steps",
            "Leave time out if the file is right; if its time is wrong, rename or delete that column.",
        )
    ]


def _may_be(own: float, step: float, unit: str, where: str) -> bool:
    """Whether steps of a time column are the sample time; without a unit it may also count the samples."""
    if is_unit(unit):
        ratios = [own * unit_factor(unit, where, "s", 1.0)[0] / step]
    else:
        ratios = [1.0] if own == 1.0 else [own / step / factor for factor in _TIME_FACTORS]
    return any(abs(ratio - 1.0) <= RASTER_TOLERANCE for ratio in ratios)

"""Time and signals as a file holds them, in SI; what is asked for is found in the file's table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput, Problem
from ...recording import SIGNAL_UNITS
from ..tables.channels import Channel
from ..tables.columns import Column, Table
from ..tables.units import COUNT_UNITS, parse_quantity
from .checks import Place, rounded_to_decimals, stop_at_errors
from .contradictions import one_column_for_two, two_sample_times


@dataclass(frozen=True, eq=False)
class RawSignals:
    """Time and signals in SI before the checks; ``place`` names the line or row of a sample.

    ``rounded``: the motor speed stands in the file with few decimals.
    """

    time: NDArray[np.float64]
    signals: dict[str, NDArray[np.float64]]
    place: Place
    sources: dict[str, str]
    rounded: bool = False
    warnings: tuple[Problem, ...] = ()


def signals_of_table(table: Table, where: str, time: Any, channels: Mapping[str, Any] | None) -> RawSignals:
    """The columns asked for, in SI; all errors together."""
    specs, problems = _specs(table, where, time, channels)
    columns, more = table.columns({name: channel.column for name, channel in specs.items()})
    problems += more
    signals: dict[str, NDArray[Any]] = {}
    for name, column in columns.items():
        try:
            signals[name] = specs[name].to_si(column, name, f"{where}, {name} ({column.label})")
        except InvalidInput as error:
            problems.append(error.problem)
        else:
            disagreement = specs[name].disagreement(column, f"{where}, {name} ({column.label})")
            problems += [] if disagreement is None else [disagreement]
    problems += one_column_for_two(columns, where)
    stop_at_errors(problems)
    if isinstance(time, Mapping) and "sample_time" in time:
        step = _sample_time(time, where)
        stop_at_errors(two_sample_times(table, step, next(iter(specs.values())).column, where))
        signals["time"] = step * np.arange(next(iter(signals.values())).size)
    place = next(iter(columns.values())).place
    sources = {name: column.label for name, column in columns.items() if name != "time"}
    return RawSignals(
        signals.pop("time"), signals, place, sources, _rounded_speed(specs, columns), tuple(problems)
    )


def _rounded_speed(specs: Mapping[str, Channel], columns: Mapping[str, Column]) -> bool:
    speed = columns.get("speed_motor")
    if speed is None or (specs["speed_motor"].unit or speed.unit) in COUNT_UNITS:
        return False
    return rounded_to_decimals(speed.values)


def _specs(
    table: Table, where: str, time: Any, channels: Mapping[str, Any] | None
) -> tuple[dict[str, Channel], list[Problem]]:
    """The channel of every signal and of the time, and the problems with what was asked for."""
    known = table.known_signals()
    wanted: dict[str, Any] = dict(channels or {n: c for n, c in known.items() if n != "time"})
    problems: list[Problem] = []
    if not wanted:
        expected = "columns that bear the names of signals: " + ", ".join(SIGNAL_UNITS)
        remedy = "Say which column is which: channels.speed_motor = { column = ..., unit = ... }."
        problems.append(Problem("error", where, "no channels", expected, remedy))
    specs: dict[str, Channel] = {}
    if isinstance(time, Mapping) and "sample_time" in time:
        if set(time) != {"sample_time"}:
            remedy = "Leave the rest out, or give a column."
            problems.append(
                Problem("error", f"{where}, time", f"keys {sorted(time)}", "sample_time alone", remedy)
            )
    else:
        wanted["time"] = time
    for name, spec in wanted.items():
        try:
            if name == "time" and spec is None:
                first = next(iter(specs.values())).column if specs else ""
                spec = known.get("time", table.time_of(first))
                if spec is None:
                    raise InvalidInput(
                        f"{where}, time",
                        "no time",
                        "a column, or a sample time",
                        'Give time = { column = 0, unit = "s" }, or time = { sample_time = "0.1 ms" }.',
                    )
            specs[name] = Channel.of(spec, f"{where}, {name}")
        except InvalidInput as error:
            problems.append(error.problem)
    return specs, problems


def _sample_time(time: Mapping[str, Any], where: str) -> float:
    step = parse_quantity(time["sample_time"], "s", f"{where}, time.sample_time")
    if step <= 0.0:
        raise InvalidInput(f"{where}, time.sample_time", f"{step!r} s", "more than 0", "Check the sign.")
    return step

"""The leaderboard of the observers: one row for each, one column for each group of cases, the error as colour."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InvalidInput
from ..score_map import score_map, wrapped

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colour scale: load-speed error in % of range, from as good as perfect to as bad as the motor speed (option).
BEST, WORST = 0.05, 20.0
#: Behind the name of an observer that reads the shaft's torque sensor.
SENSOR_MARK = "†"


def leaderboard(board: Mapping[str, Any], *, metric: str = "speed_load", axes: Axes | None = None) -> Figure:
    """The error of every observer in every group of cases, best observer on top.

    Parameters
    ----------
    board : mapping
        As ``Leaderboard.to_dict`` gives it, or read from leaderboard.json.
    metric : str
        One of speed_load, torque_shaft, twist_elastic.
    axes : Axes, optional

    Returns
    -------
    Figure
    """
    if not {"observers", "cases"} <= set(board):
        raise InvalidInput(
            "plot.leaderboard",
            f"keys {sorted(board)}",
            "those of a leaderboard",
            "Take what leaderboard.json holds.",
        )
    names = [row["name"] for row in board["observers"]]
    groups = {case["group"]: case.get("column", case["group"]) for case in board["cases"]}
    values = np.full((len(names), len(groups)), np.nan)
    for case in board["cases"]:
        column = list(groups).index(case["group"])
        for row, name in enumerate(names):
            found = case["observers"][name].get(metric)
            if found is not None:
                values[row, column] = np.nanmax([values[row, column], 100.0 * found[0]])
    if not np.isfinite(values).any():
        raise InvalidInput(
            "plot.leaderboard", f"no {metric}", "a leaderboard with that metric", "Check the name."
        )
    figure, axis = _axes(axes, len(names), len(groups))
    labels = [_label(row) for row in board["observers"]]
    score_map(axis, values, labels, tuple(groups.values()), (BEST, WORST))
    title = [wrapped(line, 11 * max(4, len(groups))) for line in _title(board, metric)]
    axis.set_title("\n".join(title), fontsize=11, fontweight="bold", loc="left", pad=14)
    return figure


def _title(board: Mapping[str, Any], metric: str) -> list[str]:
    words = {"speed_load": "load speed", "torque_shaft": "shaft torque", "twist_elastic": "elastic twist"}
    lines = [
        f"Error of the {words.get(metric, metric)} in % of range, worst case of each column "
        f"(median of {len(board['seeds'])} rigs)",
        f"blue is good, red is bad; × is the mean error relative to {board['reference']}",
    ]
    if any(row.get("needs_torque_sensor") for row in board["observers"]):
        lines.append(f"{SENSOR_MARK} needs a torque sensor on the shaft")
    return lines


def _label(row: Mapping[str, Any]) -> str:
    """Name, mark of the torque sensor, mean error relative to the reference."""
    name = f"{row['name']} {SENSOR_MARK}" if row.get("needs_torque_sensor") else row["name"]
    return name if row["overall_ratio"] is None else f"{name}   × {row['overall_ratio'][0]:.2f}"


def _axes(axes: Axes | None, rows: int, columns: int) -> tuple[Figure, Axes]:
    if axes is None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=(3.4 + 1.02 * columns, 1.6 + 0.42 * rows), layout="constrained")
        axes = figure.subplots()
    return axes.get_figure(root=True), axes  # type: ignore[return-value]

"""Identified parameters with their 95 % intervals, each relative to its own value."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ...errors import InvalidInput
from ...plain_data import shown
from ..style import ESTIMATED, TRUTH, panels, symlog

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def identified_parameters(
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    truth: Mapping[str, float | None] | None = None,
    axes: Axes | None = None,
) -> Figure:
    """Values with intervals in per cent of the value; hollow markers for the truth where it is known.

    The axis is linear within ±1 % and logarithmic beyond, since well and poorly known parameters stand side
    by side.

    Parameters
    ----------
    parameters : mapping of name → {"value", "low", "high", "unit", "source"}
        As in ``results.json``; SI; ``value`` is None where it was not excited, ``low`` and ``high`` are None
        where there is no interval.
    truth : mapping of name → float, optional
        The equivalents of the virtual rig, SI.
    axes : Axes, optional

    Returns
    -------
    Figure
    """
    if not parameters or not all(isinstance(entry, Mapping) for entry in parameters.values()):
        raise InvalidInput(
            "plot.identified_parameters", shown(parameters), "a table of values for each name",
            "Give identification.table().",
        )  # fmt: skip
    figure, (axis,) = panels(axes, 1, size=(8.5, 0.9 + 0.42 * max(len(parameters), 3)))
    for row, (name, entry) in enumerate(parameters.items()):
        value, low, high = entry.get("value"), entry.get("low"), entry.get("high")
        if not value:
            note = "not excited" if value is None else f"0 ({entry.get('source', 'given')})"
            box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0}
            axis.annotate(note, (0.0, row), ha="center", va="center", color="#555555", bbox=box)
            continue
        percent = 100.0 / abs(value)
        if low is not None and high is not None:
            reach = [[max(0.0, (value - low) * percent)], [max(0.0, (high - value) * percent)]]
            style = {"color": ESTIMATED["color"], "capsize": 4, "elinewidth": 2, "markersize": 6}
            axis.errorbar([0.0], [row], xerr=reach, fmt="o", label="value with 95 % interval", **style)
        else:
            axis.plot([0.0], [row], "s", color="#777777", label="given, without interval")
        true = truth.get(name) if truth else None
        if true is not None:
            label = "truth (virtual rig)"
            axis.plot(
                [(true - value) * percent], [row], "D", markersize=8, label=label, linestyle="none", **TRUTH
            )
    _finish(axis, list(parameters))
    return figure


def _finish(axis: Axes, names: list[str]) -> None:
    symlog(axis, 1.0, "deviation from the value", "%")
    reach = max(2.0, *(abs(x) for x in axis.get_xlim()))
    axis.set_xlim(-1.3 * reach, 1.3 * reach)
    axis.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
    axis.set_ylim(len(names) - 0.4, -0.6)
    axis.axvline(0.0, color="#999999", linewidth=0.8)
    axis.set_title("Parameters with 95 % intervals", fontweight="bold")
    handles, labels = axis.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    if unique:
        axis.figure.legend(unique.values(), unique.keys(), frameon=False, loc="outside lower center", ncols=3)

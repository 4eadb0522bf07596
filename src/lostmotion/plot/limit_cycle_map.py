"""Where limit cycles exist over two parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..argument_checks import checks_arguments
from ..certificates import LimitCycleMap
from ..display.numbers import digits
from .style import panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours from the smallest to the largest swing: light to dark, also in grey print; rest is white.
COLOURS = "YlOrBr"


@checks_arguments
def limit_cycle_map(
    found: LimitCycleMap, *, title: str = "Limit cycles (simulated)", axes: Axes | None = None
) -> Figure:
    """The swing of the load speed as a colour, the frequency of the exact orbit in Hz as a number in each cell.

    White: the loop comes to rest. "~": it swings without a period that repeats. A ring: describing functions expect a
    stable limit cycle.

    Parameters
    ----------
    found : LimitCycleMap
    title : str
    axes : Axes, optional

    Returns
    -------
    Figure
    """
    figure, (axis,) = panels(axes, 1, size=(7.0, 4.6))
    axis.grid(False)
    swing = np.where(found.swing > 0.0, found.swing, np.nan)
    image = axis.imshow(swing, cmap=COLOURS, aspect="auto", origin="lower", vmin=0.0)
    figure.colorbar(image, ax=axis, label="swing of the load speed (rad/s)")
    largest = np.nanmax(swing) if np.any(np.isfinite(swing)) else 1.0
    for (row, column), value in np.ndenumerate(found.swing):
        if value > 0.0:
            frequency = found.frequency[row, column]
            text = digits(float(frequency), 2) if np.isfinite(frequency) else "~"
            ink = "white" if value > 0.6 * largest else "#222222"
            axis.text(column, row, text, ha="center", va="center", fontsize=8, color=ink)
    rows, columns = np.nonzero(found.expected)
    axis.plot(
        columns - 0.33, rows + 0.3, "o", markersize=5, markerfacecolor="none", markeredgecolor="#0B4F8A",
        label="expected by describing functions; number: Hz; ~: no period; white: at rest",
    )  # fmt: skip
    axis.set_xticks(range(found.first_values.size), [f"{value:g}" for value in found.first_values])
    axis.set_yticks(range(found.second_values.size), [f"{value:g}" for value in found.second_values])
    axis.set_xlabel(_label(*found.first))
    axis.set_ylabel(_label(*found.second))
    figure.suptitle(title, fontsize=12, fontweight="bold")
    figure.legend(loc="outside lower center", frameon=False)
    return figure


def _label(name: str, unit: str) -> str:
    return f"{name} ({unit or '1'})"

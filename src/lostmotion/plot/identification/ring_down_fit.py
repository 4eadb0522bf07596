"""Damped oscillation fitted to a signal after its steps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import ESTIMATED, MEASURED, axis_label, display_unit, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def ring_down_fit(
    windows: Sequence[tuple[ArrayLike, ArrayLike, ArrayLike]],
    *,
    signal: str = "torque_shaft",
    source: str = "measured",
    title: str = "Ring-down",
    columns: int = 2,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Measured signal and fitted damped oscillation after each step, one panel for each.

    Parameters
    ----------
    windows : sequence of (time, measured, fitted), (n,) arrays each, s and SI
    signal : str
        The signal's name; it gives label and unit.
    source : str
        What the signal is called in the legend: "simulated" if it is that, see ``source_of``.
    title : str
    columns : int
    axes : sequence of Axes, optional
        One for each window.

    Returns
    -------
    Figure
    """
    count = len(windows)
    columns = max(min(columns, count), 1)
    size = (10.0, 1.2 + 2.4 * -(-count // columns))
    figure, grid = panels(axes, count, columns=columns, size=size)
    factor, _ = display_unit(signal)
    for axis, (time, measured, fitted) in zip(grid, windows, strict=True):
        rows_of_one_length("ring_down_fit", time=time, measured=measured, fitted=fitted)
        axis.plot(time, factor * np.asarray(measured), label=source, **MEASURED)
        axis.plot(time, factor * np.asarray(fitted), label="fitted oscillation", **ESTIMATED)
        axis.set(xlabel="time (s)", ylabel=axis_label(signal))
        axis.margins(x=0.0)
    grid[0].legend(frameon=False)
    figure.suptitle(title, fontweight="bold")
    return figure

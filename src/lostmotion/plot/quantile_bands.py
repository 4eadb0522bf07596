"""Quantiles of a signal over the variants of a batch, as bands over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InvalidInput
from .style import ESTIMATED, MEASURED, axis_label, display_unit, panels, title_and_legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def quantile_bands(
    time: ArrayLike,
    bands: Mapping[str, ArrayLike],
    *,
    single: Mapping[str, ArrayLike] | None = None,
    title: str = "Variants",
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """One panel for each signal: 5 to 95 % and 25 to 75 % of the variants, their median, and one variant's own curve.

    Parameters
    ----------
    time : (t,) array, s
    bands : mapping of signal → (5, t) array
        Quantiles at 5, 25, 50, 75 and 95 %.
    single : mapping of signal → (t,) array, optional
        The drivetrain in the middle of the variants.
    title : str
    axes : sequence of Axes, optional
        One for each signal.

    Returns
    -------
    Figure
    """
    figure, grid = panels(axes, len(bands), size=(10.0, 1.2 + 2.0 * len(bands)), sharex=True)
    color = ESTIMATED["color"]
    for axis, (signal, rows) in zip(grid, bands.items(), strict=True):
        factor, _ = display_unit(signal)
        if np.shape(rows) != (5, len(np.asarray(time))):
            raise InvalidInput(
                "plot.quantile_bands", f"{signal} of shape {np.shape(rows)}", f"shape (5, {np.size(time)})",
                "Take a row for each of five quantiles, as simulate_batch gives them.",
            )  # fmt: skip
        lowest, low, middle, high, highest = factor * np.asarray(rows, dtype=float)
        axis.fill_between(
            time, lowest, highest, color=color, alpha=0.2, linewidth=0.0, label="90 % of the variants"
        )
        axis.fill_between(
            time, low, high, color=color, alpha=0.4, linewidth=0.0, label="half of the variants"
        )
        axis.plot(time, middle, color=color, linewidth=1.3, label="median")
        if single is not None and signal in single:
            values = factor * np.asarray(single[signal], dtype=float)
            axis.plot(time, values, color=MEASURED["color"], linewidth=0.9, label="as given")
        axis.set_ylabel(axis_label(signal).replace(" (", "\n("))
        axis.margins(x=0.0)
    title_and_legend(figure, grid[:1], title)
    grid[-1].set_xlabel("time (s)")
    figure.align_ylabels(grid)
    return figure

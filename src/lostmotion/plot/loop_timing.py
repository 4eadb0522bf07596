"""Times of a law and a rig as two processes: wake-up delay and round trip, as histograms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..argument_checks import checks_arguments, not_negative
from ..display.numbers import quantity
from .style import ESTIMATED, SET_POINT, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Bins of a histogram, and the shortest time that has one of its own, s (option).
BINS, SHORTEST = 60, 1e-7


@checks_arguments
def loop_timing(
    round_trip: ArrayLike,
    wake_up: ArrayLike = (),
    *,
    period: float,
    title: str = "Timing of this machine",
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """How often which time came, both axes logarithmic: rare long times are what a deadline is missed by.

    Parameters
    ----------
    round_trip : (n,) array, s
        From the inputs until the outputs; NaN: too late, not counted.
    wake_up : (n,) array, s, optional
        Delay after each tick; a second panel.
    period : float, s
        The sample time, drawn as the deadline.
    title : str
    axes : sequence of Axes, optional
        Two with ``wake_up``, else one.

    Returns
    -------
    Figure
    """
    not_negative("plot.loop_timing.period", period, positive=True)
    shown = {
        "round trip": np.asarray(round_trip, dtype=float),
        "wake-up after the tick": np.asarray(wake_up, dtype=float),
    }
    shown = {name: values[~np.isnan(values)] for name, values in shown.items() if values.size}
    figure, grid = panels(axes, len(shown), columns=2, size=(5.0 * len(shown), 3.4), sharey=True)
    largest = max([period, *(float(values.max()) for values in shown.values() if values.size)])
    edges = np.geomspace(SHORTEST, 1.5 * largest, BINS + 1).tolist()
    for axis, (name, values) in zip(grid, shown.items(), strict=True):
        axis.hist(np.clip(values, SHORTEST, None), bins=edges, color=ESTIMATED["color"])
        axis.axvline(period, label="sample time", **SET_POINT)
        axis.set(
            xscale="log", yscale="log" if values.size else "linear", xlabel=f"{name} (s)", ylabel="samples"
        )
        if values.size:
            middle, high = (quantity(float(v), "s") for v in (np.median(values), values.max()))
            axis.set_title(f"median {middle}, largest {high}", loc="left", fontsize=10)
        axis.legend(frameon=False, loc="upper right")
    figure.suptitle(title, fontsize=12, fontweight="bold")
    return figure

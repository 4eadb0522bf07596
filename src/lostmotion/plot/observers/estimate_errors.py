"""Errors of estimates within the band of their standard deviation, with the times in the gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...recording import Recording
from ..style import ESTIMATED, MEASURED, display_unit, panels, title_and_legend, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def estimate_errors(
    estimates: Mapping[str, Recording],
    exact: Recording,
    *,
    signal: str = "speed_load",
    gap: ArrayLike | None = None,
    span: tuple[float, float] | None = None,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """One panel per observer: the error of an estimate within twice its standard deviation.

    Parameters
    ----------
    estimates : mapping of name → Recording
        Each with ``<signal>_estimated`` and ``<signal>_deviation``, row by row as ``exact``.
    exact : Recording
        The true signal.
    signal : str
    gap : (n,) array of bool, optional
        Rows in which the joint is open.
    span : (float, float), s, optional
        Times that are drawn; default all.
    axes : sequence of Axes, optional
        One for each observer.

    Returns
    -------
    Figure
    """
    figure, grid = panels(
        axes, len(estimates), size=(10.0, 1.4 + 1.9 * len(estimates)), sharex=True, sharey=True
    )
    factor, unit = display_unit(signal)
    time = exact.time
    rows = slice(None) if span is None else slice(*np.searchsorted(time, span))
    for axis, (name, estimate) in zip(grid, estimates.items(), strict=True):
        error = factor * (estimate[f"{signal}_estimated"] - exact[signal])[rows]
        band = 2.0 * factor * estimate[f"{signal}_deviation"][rows]
        if gap is not None:
            open_ = np.asarray(gap, dtype=bool)[rows]
            axis.fill_between(
                time[rows], 0.0, 1.0, where=open_, transform=axis.get_xaxis_transform(), color="#e4e4e4",
                linewidth=0.0, step="post", label="joint open",
            )  # fmt: skip
        axis.fill_between(
            time[rows], -band, band, color=MEASURED["color"], alpha=0.45, linewidth=0.0,
            label="± twice the standard deviation",
        )  # fmt: skip
        axis.plot(time[rows], error, label="estimated − true", **ESTIMATED)
        axis.set(ylabel=f"{name}\nerror ({unit})")
        axis.margins(x=0.0)
    grid[-1].set_xlabel("time (s)")
    figure.align_ylabels(grid)
    title_and_legend(figure, grid, f"Error of the {words(signal)} and its standard deviation")
    return figure

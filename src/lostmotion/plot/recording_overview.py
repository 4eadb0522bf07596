"""All signals of a recording under each other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..argument_checks import checks_arguments
from ..recording import Recording
from .style import ESTIMATED, axis_label, display_unit, is_held, panels, thin_min_max

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@checks_arguments
def recording_overview(
    recording: Recording,
    *,
    title: str = "Recording",
    signals: Sequence[str] | None = None,
    bins: int = 1000,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """One panel per signal over the whole time, thinned to the extremes of each of ``bins`` parts.

    Parameters
    ----------
    recording : Recording
    title : str
        Say here if the recording is simulated.
    signals : sequence of str, optional
        Default: all.
    bins : int
        So many parts are drawn at most, so that 100 000 samples stay light.
    axes : sequence of Axes, optional
        One for each signal.

    Returns
    -------
    Figure
    """
    shown = list(recording.names if signals is None else signals)
    figure, grid = panels(axes, len(shown), size=(10.0, 1.0 + 1.35 * len(shown)), sharex=True)
    for axis, signal in zip(grid, shown, strict=True):
        factor, _ = display_unit(signal)
        time, values = thin_min_max(recording.time, factor * recording[signal], bins)
        style = "steps-post" if is_held(signal) else "default"
        axis.plot(time, values, color=ESTIMATED["color"], linewidth=0.7, drawstyle=style)
        axis.set_ylabel(axis_label(signal).replace(" (", "\n("))
        axis.set_xlim(recording.time[0], recording.time[-1])
    grid[0].set_title(title, fontweight="bold")
    grid[-1].set_xlabel("time (s)")
    figure.align_ylabels(grid)
    return figure

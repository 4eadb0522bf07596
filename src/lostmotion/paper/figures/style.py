"""The look of the paper's figures: one column wide, small type, the paper's symbols, the package's colours."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...plot.frequency.bode import plain_ticks
from ...plot.style import ESTIMATED, MEASURED, SERIES, SET_POINT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Width of a column, in (option: 89 mm, as in two-column proceedings).
COLUMN = 3.5
#: Type sizes, points, and grid (option: eight points is what such a column has).
SETTINGS: Any = {
    "font.size": 8.0, "axes.titlesize": 8.0, "legend.fontsize": 7.0, "xtick.labelsize": 7.5, "ytick.labelsize": 7.5,
    "axes.linewidth": 0.7, "axes.grid": True, "axes.axisbelow": True, "grid.color": "#d9d9d9", "grid.linewidth": 0.5,
    "axes.spines.top": False, "axes.spines.right": False, "legend.frameon": False, "axes.labelpad": 2.0,
}  # fmt: skip
#: Characters of a legend that fit into one line of a column (option).
WIDEST_LEGEND = 45
#: Line of each curve: wide and light below, thin and dark above, so that both are seen where they coincide.
MEASUREMENT = {**MEASURED, "linewidth": 2.4}
MODEL = {**ESTIMATED, "linewidth": 1.0}
THIRD = {**SERIES[2], "linewidth": 1.2}
REFERENCE = {**SET_POINT, "linewidth": 0.9}

#: Axis labels in the paper's symbols.
LABELS = {
    "torque_motor": r"$M_e$ (Nm)",
    "twist": r"$\varphi_e - \varphi_w$ (mrad)",
    "speed_motor": r"$\dot\varphi_e$ (rad/s)",
    "speed_load": r"$\dot\varphi_w$ (rad/s)",
}


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A figure of the paper, or of an answer to its outlook, drawn from the virtual rig.

    Parameters
    ----------
    number : int or str
        In the paper; a word for a figure that the paper has not.
    title, caption : str
    image : Figure
    """

    number: int | str
    title: str
    caption: str
    image: Figure

    @property
    def name(self) -> str:
        """Of its files, without a suffix: so that a folder lists them in order."""
        return f"figure-{self.number:02d}" if isinstance(self.number, int) else f"outlook-{self.number}"

    @property
    def wide(self) -> bool:
        """Whether it needs more than one column."""
        return bool(self.image.get_size_inches()[0] > 1.5 * COLUMN)


def styled() -> AbstractContextManager[None]:
    """Around drawing and saving: the settings end with the block."""
    from matplotlib import rc_context

    return rc_context(SETTINGS)


def column(rows: int, height: float, **grid: Any) -> tuple[Figure, list[Axes]]:
    """A figure of one column and so many panels above each other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN, height), layout="constrained")
    panels = figure.subplots(rows, 1, squeeze=False, **grid).ravel()
    figure.align_ylabels(panels)
    return figure, list(panels)


def beside(height: float) -> tuple[Figure, tuple[Axes, Axes]]:
    """A figure of one column with two panels beside each other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN, height), layout="constrained")
    left, right = figure.subplots(1, 2)
    return figure, (left, right)


def finish_phase(
    panel: Axes, band: tuple[float, float], ticks: Sequence[float], ends: tuple[float, float]
) -> None:
    """The lower panel of a Bode plot: degrees over the frequency, with numbers instead of powers of ten."""
    panel.set(ylabel="phase (degrees)", yticks=ticks, ylim=ends, xlabel="frequency (Hz)", xlim=band)
    plain_ticks(panel)


def legend(figure: Figure, panels: Sequence[Axes]) -> None:
    """One for all panels, below them."""
    entries: dict[str, Any] = {}
    for panel in panels:
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    columns = 3 if sum(map(len, entries)) <= WIDEST_LEGEND else 2
    figure.legend(
        entries.values(), entries.keys(), loc="outside lower center", ncols=columns, columnspacing=1.2
    )

"""A table of numbers as colours: a row for each entry, a column for each group of cases."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Within this factor of the smallest number of its column, a number counts as the best (option).
AS_GOOD = 1.02


def score_map(
    axis: Axes,
    values: NDArray[np.float64],
    rows: Sequence[str],
    columns: Sequence[str],
    scale: tuple[float, float],
) -> None:
    """Draw (rows, columns) numbers; ``scale`` is the blue and the red end of the logarithmic colours."""
    from matplotlib.colors import LogNorm

    # Zero has no logarithm: it has the colour of the best.
    shown = np.maximum(values, scale[0])
    axis.imshow(shown, cmap="RdYlBu_r", norm=LogNorm(*scale), aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        text = "–" if not np.isfinite(value) else f"{value:.2g}" if value < 9.95 else f"{value:.0f}"
        best = np.isfinite(value) and value <= AS_GOOD * np.nanmin(values[:, column])
        axis.text(
            column, row, text, ha="center", va="center", fontsize=9, fontweight="bold" if best else "normal",
            color=_ink(value, scale),
        )  # fmt: skip
    axis.set_yticks(range(len(rows)), rows)
    axis.set_xticks(range(len(columns)), [wrapped(name) for name in columns])
    axis.set_xticks(np.arange(values.shape[1] + 1) - 0.5, minor=True)
    axis.set_yticks(np.arange(values.shape[0] + 1) - 0.5, minor=True)
    axis.grid(which="minor", color="white", linewidth=1.5)
    axis.tick_params(which="minor", length=0)
    axis.tick_params(length=0, top=True, bottom=False, labeltop=True, labelbottom=False)
    axis.spines[:].set_visible(False)


def _ink(value: float, scale: tuple[float, float]) -> str:
    """White on the dark ends of the colour scale."""
    best, worst = scale
    place = np.log(max(value, best) / best) / np.log(worst / best) if np.isfinite(value) else 0.5
    return "white" if place < 0.12 or place > 0.85 else "#222222"


def wrapped(text: str, width: int = 12) -> str:
    """The text in lines of that many letters."""
    return "\n".join(textwrap.wrap(text, width))

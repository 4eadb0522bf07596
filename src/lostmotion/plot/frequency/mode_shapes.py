"""Mode shapes of a torsional chain along its nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...errors import InvalidInput
from ..style import ESTIMATED, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def mode_shapes(
    frequency: ArrayLike,
    shapes: ArrayLike,
    names: Sequence[str],
    *,
    count: int = 3,
    labelled: Sequence[str] | None = None,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """The first eigenmodes, each scaled to a largest angle of 1, one panel for each.

    Parameters
    ----------
    frequency : (modes,) array, Hz
    shapes : (nodes, modes) array
        Angles; any scale.
    names : sequence of str
        Of the nodes.
    count : int
        Number of eigenmodes.
    labelled : sequence of str, optional
        Names to write below; default: all without a dot, which finite elements inside a shaft have.
    axes : sequence of Axes, optional

    Returns
    -------
    Figure
    """
    frequency, shapes = np.asarray(frequency, dtype=float), np.asarray(shapes, dtype=float)
    if shapes.shape != (len(names), frequency.size):
        raise InvalidInput(
            "plot.mode_shapes", f"shapes {shapes.shape}", f"({len(names)}, {frequency.size}): a row for each name, a "
            "column for each frequency", "Take both from one model.",
        )  # fmt: skip
    count = min(count, frequency.size)
    figure, grid = panels(axes, count, size=(8.0, 1.0 + 1.75 * count), sharex=True)
    place = np.arange(len(names))
    shown = [
        i for i, name in enumerate(names) if (name in labelled if labelled is not None else "." not in name)
    ]
    for mode, axis in enumerate(grid):
        shape = shapes[:, mode] / np.max(np.abs(shapes[:, mode]))
        axis.axhline(0.0, color="#777777", linewidth=0.8)
        axis.fill_between(place, shape, color=ESTIMATED["color"], alpha=0.12, linewidth=0.0)
        axis.plot(place, shape, **ESTIMATED)
        axis.plot(place[shown], shape[shown], "o", color=ESTIMATED["color"], markersize=5)
        axis.set(ylim=(-1.15, 1.15), ylabel="angle (relative)")
        axis.set_title(
            f"{frequency[mode]:.4g} Hz" if frequency[mode] else "0 Hz: rigid rotation",
            loc="left",
            fontsize=10,
        )
    grid[-1].set_xticks(place[shown], [names[i] for i in shown], rotation=30, ha="right")
    grid[-1].set_xlabel("place along the chain (node)")
    figure.suptitle("Mode shapes", fontsize=12, fontweight="bold")
    return figure

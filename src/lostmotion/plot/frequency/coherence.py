"""Coherence of one or several frequency responses."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import SERIES, panels, title_and_legend
from .bode import plain_ticks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def coherence(
    coherences: Mapping[str, tuple[ArrayLike, ArrayLike]],
    *,
    by_chance: float | None = None,
    title: str = "Coherence",
    axes: Axes | None = None,
) -> Figure:
    """Magnitude-squared coherence over frequency, at most four.

    Parameters
    ----------
    coherences : mapping of label → (frequency, coherence)
        (m,) arrays, Hz and 0 … 1.
    by_chance : float, optional
        Level that unrelated signals exceed in 5 % of the frequencies.
    title : str
    axes : Axes, optional

    Returns
    -------
    Figure
    """
    figure, (axis,) = panels(axes, 1, size=(8.0, 3.8))
    for (label, (frequency, values)), style in zip(coherences.items(), SERIES, strict=False):
        rows_of_one_length("coherence", frequency=frequency, coherence=values)
        axis.plot(np.asarray(frequency), np.asarray(values), label=label, **style)
    if by_chance is not None:
        axis.axhline(
            by_chance, color="#777777", linewidth=0.9, linestyle=(0, (1, 2)), label="by chance (5 %)"
        )
    axis.set(xscale="log", xlabel="frequency (Hz)", ylabel="coherence (1)", ylim=(0.0, 1.03))
    plain_ticks(axis)
    title_and_legend(figure, [axis], title)
    return figure

"""The map of limit cycles: units on all axes, a number in each cell that swings, no global setting touched."""

from __future__ import annotations

import matplotlib
import numpy as np

from lostmotion import plot
from lostmotion.certificates import LimitCycleMap


def found(swing: list[list[float]]) -> LimitCycleMap:
    size = np.array(swing)
    return LimitCycleMap(
        ("backlash", "mrad"), ("share", ""), np.array([0.0, 6.0, 12.0]), np.array([0.5, 1.0]), size,
        np.where(size > 1.0, 6.4, np.nan), size > 0.5,
    )  # fmt: skip


def test_figure() -> None:
    before = dict(matplotlib.rcParams)
    figure = plot.limit_cycle_map(found([[0.0, 0.0, 0.3], [0.0, 2.0, 3.0]]))
    figure.canvas.draw()
    assert dict(matplotlib.rcParams) == before
    axis, bar = figure.axes
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("backlash (mrad)", "share (1)")
    assert bar.get_ylabel() == "swing of the load speed (rad/s)"
    assert [text.get_text() for text in axis.texts] == ["~", "6.4", "6.4"]
    assert len(axis.lines[0].get_xdata()) == 2
    image = axis.images[0].get_array()
    assert np.ma.getmaskarray(image).sum() == 3, "rest is white"


def test_a_map_without_limit_cycles_is_white() -> None:
    figure = plot.limit_cycle_map(found([[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]))
    figure.canvas.draw()
    assert not figure.axes[0].texts

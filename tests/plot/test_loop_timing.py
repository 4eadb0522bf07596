"""Histograms of a loop's times: a panel each, the sample time in both, what came too late is not counted."""

from __future__ import annotations

import numpy as np

from lostmotion import plot

ROUND_TRIP = np.array([1e-5, 2e-5, 2e-5, np.nan, 3e-4])


def counted(axis) -> int:
    return int(sum(bar.get_height() for bar in axis.patches))


def test_lock_step_has_one_panel_and_paced_two() -> None:
    alone = plot.loop_timing(ROUND_TRIP, period=1e-4)
    assert len(alone.axes) == 1
    both = plot.loop_timing(ROUND_TRIP, [0.0, 1e-6, 2e-3, 1e-5, 1e-5], period=1e-4)
    assert [axis.get_xlabel() for axis in both.axes] == ["round trip (s)", "wake-up after the tick (s)"]
    assert [counted(axis) for axis in both.axes] == [4, 5]  # nothing falls out of the bins
    assert both.axes[1].get_title(loc="left") == "median 10.0\u00a0µs, largest 2.00\u00a0ms"
    for axis in both.axes:
        assert axis.get_xscale() == axis.get_yscale() == "log"
        assert [line.get_xdata()[0] for line in axis.lines] == [1e-4]


def test_a_run_without_one_answer_in_time_is_drawn_too() -> None:
    figure = plot.loop_timing([np.nan, np.nan], [1e-3, 1e-3], period=1e-4)
    assert [counted(axis) for axis in figure.axes] == [0, 2]
    assert [axis.get_title(loc="left") for axis in figure.axes] == [
        "",
        "median 1.00\u00a0ms, largest 1.00\u00a0ms",
    ]

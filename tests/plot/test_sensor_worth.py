"""The figure of the torque sensor's worth."""

from __future__ import annotations

import numpy as np

from lostmotion.plot import sensor_worth


def test_lines_intervals_and_break_even():
    rows = [(0.5, 0.4, 0.6), (1.5, 1.2, 2.0)]
    figure = sensor_worth((0.1, 10.0), {"load speed": rows, "shaft torque": rows}, {"load speed": 3.0})
    axis = figure.axes[0]
    lines = {line.get_label(): line for line in axis.lines}
    np.testing.assert_array_equal(lines["load speed"].get_ydata(), [0.5, 1.5])
    assert [text.get_text() for text in axis.texts if "Nm" in text.get_text()] == ["3 Nm"]
    assert axis.get_xscale() == axis.get_yscale() == "log"
    assert len(axis.collections) == 2

"""Figures of friction, locked-load backlash and lost motion: labelled axes, and the lines that they should have."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from lostmotion import plot
from lostmotion.errors import InvalidInput

TIME = np.linspace(0.0, 10.0, 5000)
TORQUE = 15.0 * np.sin(TIME)


def step() -> Figure:
    return plot.friction_fit(TIME, TORQUE, 20.0 * TIME, np.where(TIME > 1.0, 20.0 * TIME, np.nan))


def curve() -> Figure:
    speed = np.array([-8.0, -1.0, 1.0, 8.0])
    steady = np.array([True, False, True, True])
    return plot.friction_curve(speed, np.sign(speed), 0.1 + 0.0 * speed, steady, np.sign)


def locked() -> Figure:
    def fitted(torque: np.ndarray, way: float, side: float) -> np.ndarray:
        return (torque - 0.3 * way) / 6000.0 + 0.006 * side

    side = np.sign(TORQUE) * (np.abs(TORQUE) > 2.0)
    angle = fitted(TORQUE, 1.0, np.sign(TORQUE))
    return plot.backlash_locked(TORQUE, angle, side, fitted, backlash=0.012, interval=(0.0119, 0.0121))


def between() -> Figure:
    way = np.sign(np.cos(TIME))
    return plot.backlash_lost_motion(TORQUE, 1e-5 * TORQUE + 1e-4 * way, 1e-5 * TORQUE + 1e-4 * way, way)


@pytest.mark.parametrize("figure", [step, curve, locked, between])
def test_axes_are_labelled_with_units_and_nothing_global_changes(figure: object) -> None:
    before = dict(matplotlib.rcParams)
    made = figure()  # type: ignore[operator]
    assert dict(matplotlib.rcParams) == before
    assert all("(" in axis.get_ylabel() for axis in made.axes)
    assert "(" in made.axes[-1].get_xlabel()
    made.canvas.draw()


def test_fit_is_drawn_where_there_is_one() -> None:
    lines = {line.get_label(): line for line in step().axes[1].get_lines()}
    drawn = lines["fitted"].get_xdata()[np.isfinite(lines["fitted"].get_ydata())]
    assert drawn.min() > 1.0


def test_locked_load_has_four_branches_in_mrad_and_its_interval() -> None:
    axis = locked().axes[0]
    branches = [line for line in axis.get_lines() if line.get_linewidth() == 1.3]
    assert len(branches) == 4
    assert sorted(round(float(b.get_ydata()[0]), 2) for b in branches) == [-6.05, -5.95, 5.95, 6.05]
    assert "12 mrad (11.9 to 12.1)" in axis.get_title()


def test_plateaus_that_were_not_used_are_open() -> None:
    labels = [text.get_text() for text in curve().axes[0].get_legend().get_texts()]
    assert "slips and sticks: not used" in labels


def test_wrong_number_of_axes_is_refused() -> None:
    with pytest.raises(InvalidInput, match="2 axes"):
        plot.friction_fit(TIME, TORQUE, TORQUE, TORQUE, axes=[Figure().subplots()])


def test_the_speed_axis_says_where_it_is_linear() -> None:
    axis = curve().axes[0]
    assert axis.get_xlabel() == "speed (rad/s; linear within ±1, shaded, and logarithmic beyond)"
    assert [p.get_width() for p in axis.patches] == [2.0]

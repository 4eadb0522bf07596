"""Bode diagram, coherence and mode shapes: labels with units, the lines they should have, no global setting touched."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from lostmotion.plot.frequency.bode import bode
from lostmotion.plot.frequency.coherence import coherence
from lostmotion.plot.frequency.mode_shapes import mode_shapes

FREQUENCY = np.geomspace(1.0, 200.0, 300)
RESPONSE = 1.0 / (100.0 - FREQUENCY**2 + 2j * FREQUENCY)


def draw_bode(**more):
    curves = {"measured": (FREQUENCY, RESPONSE, 0.1 * np.abs(RESPONSE)), "model": (FREQUENCY, 1.1 * RESPONSE)}
    return bode(curves, marks={"pole": 10.0}, **more)


def draw_coherence(**more):
    return coherence({"measured": (FREQUENCY, np.exp(-FREQUENCY / 50.0))}, by_chance=0.1, **more)


def draw_modes(**more):
    names = ["motor", "shaft.1", "load"]
    return mode_shapes([0.0, 100.0], np.array([[1.0, 4.0], [1.0, 2.0], [1.0, -1.0]]), names, **more)


@pytest.mark.parametrize("make", [draw_bode, draw_coherence, draw_modes])
def test_figure(make):
    before = dict(matplotlib.rcParams)
    figure = make()
    figure.canvas.draw()
    assert dict(matplotlib.rcParams) == before
    assert figure.get_suptitle()
    assert figure.axes[-1].get_xlabel().endswith(")")
    assert all(axis.get_ylabel().endswith(")") for axis in figure.axes)


def test_bode_shows_decibels_degrees_bands_and_marks():
    upper, lower = draw_bode().axes
    line = upper.lines[0]
    np.testing.assert_allclose(line.get_ydata(), 20.0 * np.log10(np.abs(RESPONSE)))
    assert lower.lines[0].get_ydata()[-1] == pytest.approx(np.rad2deg(np.angle(RESPONSE[-1])), abs=1e-9)
    assert [len(upper.collections), len(lower.collections)] == [1, 1]
    assert [text.get_text() for text in upper.texts] == ["pole"]
    assert len(upper.lines) == 3


def test_bode_with_coherence_below():
    third = draw_bode(coherences={"measured": (FREQUENCY, np.full(300, 0.7))}).axes[2]
    assert third.get_ylabel() == "coherence (1)"
    assert third.lines[1].get_color() == draw_bode().axes[0].lines[0].get_color()
    assert third.get_xlabel() == "frequency (Hz)"


def test_phase_does_not_jump_across_the_panel():
    phase = np.linspace(0.0, -4.0 * np.pi, 500)
    lower = bode({"late": (np.arange(1, 501), np.exp(1j * phase))}).axes[1]
    shown = lower.lines[0].get_ydata()
    steps = np.abs(np.diff(shown))
    assert np.nanmax(steps) < 90.0
    assert np.isnan(shown).sum() in (1, 2)


def test_the_phase_of_a_speed_over_a_torque_is_one_line():
    """It turns from -90° to +90° at the zero and back at the pole."""
    s = 2j * np.pi * FREQUENCY
    zero, pole = ((2.0 * np.pi * f) ** 2 for f in (25.0, 60.0))
    response = (s**2 + 5.0 * s + zero) / (s * (s**2 + 5.0 * s + pole))
    lower = bode({"measured": (FREQUENCY, response)}).axes[1]
    shown = lower.lines[0].get_ydata()
    np.testing.assert_allclose(shown, np.rad2deg(np.angle(response)), atol=1e-9)
    low, high = lower.get_ylim()
    assert low < shown.min() and shown.max() < high and high - low == pytest.approx(380.0)
    assert [low + 10.0, high - 10.0] == [lower.get_yticks()[0], lower.get_yticks()[-1]] == [-180.0, 180.0]


def test_no_phase_is_drawn_where_every_phase_is_possible():
    """Over noise alone the phase would be a thicket of lines."""
    rng = np.random.default_rng(1)
    noise = np.exp(2j * np.pi * rng.random(300))
    known = FREQUENCY < 20.0
    response, margin = np.where(known, RESPONSE, noise), np.where(known, 0.1 * np.abs(RESPONSE), 1.1)
    lower = bode({"measured": (FREQUENCY, response, margin)}).axes[1]
    np.testing.assert_array_equal(np.isfinite(lower.lines[0].get_ydata()), known)


def test_a_phase_that_wraps_by_little_more_than_half_a_turn_is_broken():
    phase = np.deg2rad([-20.0, -100.0, 150.0, -20.0, -100.0])
    shown = bode({"rough": (np.arange(1, 6), np.exp(1j * phase))}).axes[1].lines[0].get_ydata()
    steps = np.abs(np.diff(shown))
    assert np.nanmax(steps) < 180.0


def test_modes_are_scaled_to_one_and_name_the_discs_alone():
    first, second = draw_modes().axes
    np.testing.assert_allclose(second.lines[1].get_ydata(), [1.0, 0.5, -0.25])
    assert [label.get_text() for label in second.get_xticklabels()] == ["motor", "load"]
    assert "rigid" in first.get_title(loc="left")


def test_given_axes_are_used():
    figure = Figure()
    axis = figure.add_subplot()
    assert draw_coherence(axes=axis) is figure
    assert len(axis.lines) == 2


def test_a_bode_diagram_explains_its_band_and_the_gaps_of_its_phase() -> None:
    frequency = np.linspace(1.0, 10.0, 50)
    response = 1.0 / (1.0 + 1j * frequency)
    with_band = bode({"measured": (frequency, response, 0.1 * np.abs(response))}, note="About the gap.")
    labels = with_band.legends[0].get_texts()
    assert "95 % interval" in [label.get_text() for label in labels]
    below = with_band.legends[0].get_title().get_text()
    assert "Phase: not drawn where" in below and below.endswith("About the gap.")
    without = bode({"model": (frequency, response)})
    assert "95 % interval" not in [label.get_text() for label in without.legends[0].get_texts()]
    assert without.legends[0].get_title().get_text() == ""

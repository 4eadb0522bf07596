"""Every figure: labelled axes with units, the lines that it should have, and no global setting touched."""

from __future__ import annotations

from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure

from lostmotion import plot
from lostmotion.errors import InvalidInput
from lostmotion.recording import Recording

DT = 1e-3
TIME = np.arange(2000) * DT


def recording(**extra: np.ndarray) -> Recording:
    signals = {
        "torque_motor": 5.0 * np.sin(9.0 * TIME),
        "twist": 0.006 * np.sin(9.0 * TIME),
        "speed_motor": np.where(TIME < 1.0, -2.0, 2.0),
        "speed_load": np.where(TIME < 1.01, -2.0, 2.0),
        "speed_reference": np.where(TIME < 1.0, -2.0, 2.0),
    }
    return Recording(TIME, {**signals, **extra})


def estimated() -> Recording:
    names = ("twist", "speed_motor", "speed_load")
    return Recording(TIME, {f"{name}_estimated": recording()[name] for name in names})


PARAMETERS = {
    "stiffness": {"value": 6300.0, "low": 6200.0, "high": 6400.0, "unit": "Nm/rad", "source": "identified"},
    "inertia_load": {"value": 0.1, "low": None, "high": None, "unit": "kg m2", "source": "nameplate"},
    "backlash": {"value": None, "low": None, "high": None, "unit": "rad", "source": "not excited"},
}


def observer_step() -> Figure:
    return plot.observer_step(recording(), estimated(), step_time=1.0)


def control_step() -> Figure:
    return plot.control_step({"PI": recording(), "other": recording()}, torque_limit=6.0)


def identified_parameters() -> Figure:
    return plot.identified_parameters(PARAMETERS, truth={"stiffness": 6286.0, "backlash": 0.012})


def prediction_fit() -> Figure:
    noise = 0.01 * np.random.default_rng(1).standard_normal(TIME.size)
    return plot.prediction_fit(TIME, np.sin(TIME) + noise, np.sin(TIME))


def recording_overview() -> Figure:
    return plot.recording_overview(recording())


def stiffness_fit() -> Figure:
    frequency = np.linspace(1.0, 50.0, 40)
    response = 110.0 * np.exp(-1j * 0.002 * frequency)
    arguments = {
        "fitted": response,
        "used": frequency < 30.0,
        "title": "Shaft stiffness",
        "interval": (109.0, 111.0),
    }
    return plot.stiffness_fit(frequency, response, np.full(40, 0.98), **arguments)


def ring_down_fit() -> Figure:
    wave = np.exp(-3.0 * TIME) * np.cos(180.0 * TIME)
    return plot.ring_down_fit([(TIME, wave, wave), (TIME + 3.0, wave, wave)])


#: figure → number of lines in each panel
FIGURES = {
    observer_step: [1, 2, 3, 3],
    control_step: [3, 3, 4, 2],  # both torques, both limits
    identified_parameters: None,
    prediction_fit: [2, 1, 1],
    recording_overview: [1, 1, 1, 1, 1],
    stiffness_fit: [3, 3, 1],
    ring_down_fit: [2, 2],
}


@pytest.mark.parametrize("make", FIGURES, ids=lambda make: make.__name__)
def test_figure(make):
    before = dict(matplotlib.rcParams)
    figure = make()
    figure.canvas.draw()
    assert dict(matplotlib.rcParams) == before
    titles = [axis.get_title(loc) for axis in figure.axes for loc in ("left", "center")]
    assert any([*titles, figure.get_suptitle()])
    assert any("(" in axis.get_xlabel() for axis in figure.axes)
    for axis in figure.axes:
        if make is not identified_parameters:
            assert axis.get_ylabel().endswith(")"), axis.get_ylabel()
        assert axis.get_xlabel() == "" or axis.get_xlabel().endswith(")")
    if FIGURES[make] is not None:
        assert [len(axis.lines) for axis in figure.axes] == FIGURES[make]


def test_no_pyplot_figure_is_left_open():
    from matplotlib import pyplot

    for make in FIGURES:
        make()
    assert pyplot.get_fignums() == []


def test_twist_is_drawn_in_milliradians():
    axis = next(a for a in observer_step().axes if a.get_ylabel() == "twist (mrad)")
    assert np.max(axis.lines[0].get_ydata()) > 1.0


def test_given_axes_are_used():
    figure = Figure()
    axes = list(figure.subplots(5, 1))
    assert plot.recording_overview(recording(), axes=axes) is figure
    assert all(axis.lines for axis in axes)
    with pytest.raises(InvalidInput):
        plot.recording_overview(recording(), axes=axes[:2])


def test_observer_step_without_measured_twist_draws_the_observer_alone():
    figure = plot.observer_step(recording().only("speed_motor", "speed_load"), estimated(), step_time=1.0)
    lines = {axis.get_ylabel(): [line.get_label() for line in axis.lines] for axis in figure.axes}
    assert lines["twist (mrad)"] == ["Observer 1"]
    assert "motor torque (Nm)" not in lines


def test_a_torque_far_from_its_limit_is_drawn_without_it():
    figure = plot.control_step({"PI": recording()}, torque_limit=73.5)
    torque = next(a for a in figure.axes if a.get_ylabel() == "motor torque (Nm)")
    assert len(torque.lines) == 1


def test_parameters_say_what_is_not_excited_and_what_is_the_truth():
    figure = identified_parameters()
    assert [text.get_text() for text in figure.axes[0].texts] == ["not excited"]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert set(labels) == {"value with 95 % interval", "truth (virtual rig)", "given, without interval"}
    truth = next(line for line in figure.axes[0].lines if line.get_label() == "truth (virtual rig)")
    assert truth.get_xdata()[0] == pytest.approx(100.0 * (6286.0 - 6300.0) / 6300.0)


def test_an_axis_that_is_linear_in_its_middle_alone_says_so():
    axis = identified_parameters().axes[0]
    assert axis.get_xscale() == "symlog"
    assert axis.get_xlabel() == (
        "deviation from the value (%; linear within ±1, shaded, and logarithmic beyond)"
    )
    (shade,) = axis.patches
    assert (shade.get_x(), shade.get_width()) == (-1.0, 2.0)


def test_a_long_recording_stays_light_and_keeps_its_peak():
    time = np.arange(100_000) * 1e-4
    values = np.sin(time)
    values[54_321] = 9.0
    figure = plot.recording_overview(Recording(time, {"speed_motor": values}))
    line = figure.axes[0].lines[0]
    assert len(line.get_xdata()) <= 2002
    peak = int(np.argmax(line.get_ydata()))
    assert (line.get_xdata()[peak], line.get_ydata()[peak]) == (time[54_321], 9.0)
    assert np.all(np.diff(line.get_xdata()) > 0)


def test_autocorrelation_of_an_alternating_signal():
    from lostmotion.plot.identification.prediction_fit import autocorrelation

    values = np.resize([1.0, -1.0], 1000)
    expected = [(1000 - lag) / 1000 * (-1) ** lag for lag in range(4)]
    np.testing.assert_allclose(autocorrelation(values, 3), expected, atol=1e-12)
    assert np.all(autocorrelation(np.ones(50), 3) == 0.0)


def test_a_legend_says_simulated_where_the_recording_does():
    simulated = replace(recording(), origin={"speed_load": "simulated", "speed_reference": "reference"})
    assert plot.source_of(simulated) == "simulated" and plot.source_of(recording()) == "measured"
    for shown, label in ((recording(), "measured"), (simulated, "simulated")):
        figure = plot.observer_step(shown, estimated(), step_time=1.0)
        assert figure.axes[0].lines[0].get_label() == label


@pytest.mark.parametrize("source", ["measured", "simulated"])
def test_figures_of_arrays_call_them_as_they_are_told(source):
    wave = np.sin(TIME)
    made = [
        plot.prediction_fit(TIME, wave, wave, source=source),
        plot.ring_down_fit([(TIME, wave, wave)], source=source),
        plot.friction_fit(TIME, wave, wave, wave, source=source),
        plot.backlash_locked(wave, wave, 0.0 * wave, source=source),
        plot.stiffness_fit(TIME, wave + 2.0, np.ones(TIME.size), source=source),
    ]
    for figure in made:
        labels = [str(line.get_label()) for axis in figure.axes for line in axis.lines]
        assert {label.split(",")[0] for label in labels} & {"measured", "simulated"} == {source}

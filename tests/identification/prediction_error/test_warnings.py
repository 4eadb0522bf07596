"""What is found and reported, each with a remedy."""

from __future__ import annotations

import tracemalloc
from functools import cache

import numpy as np
import pytest
from lagged_drive import DT, PLANT, speed_from_counts

import lostmotion as lm
from lostmotion.errors import InvalidInput, Problem
from lostmotion.identification import Identification
from lostmotion.identification.prediction_error.initial_values import rival
from lostmotion.identification.prediction_error.innovations import NAMES, to_theta
from lostmotion.identification.prediction_error.problems import not_excited, second_minimum
from lostmotion.identification.prediction_error.warnings import MEMORY, low_frequency_excess
from lostmotion.identification.statistics.levenberg_marquardt import Fit
from lostmotion.memory import VARIABLE


@cache
def found(
    bits: int = 20, drift: float = 0.0, factor: float = 1.0, second_estimator: bool = True
) -> Identification:
    torque = lm.signals.excitation(2.0, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    load = drift * np.sin(2.0 * np.pi * np.arange(20000) * DT / 4.0)
    run = lm.simulate(PLANT, torque_motor=torque, torque_load=load, dt=DT)
    count = 2.0 * np.pi / 2**bits
    speed = speed_from_counts(run, count)
    recording = run.only("torque_motor").with_signals("measured", speed_motor=speed)
    start = PLANT.with_parameters(stiffness=factor * PLANT.stiffness)
    return lm.identify(recording, start=start, second_estimator=second_estimator)


def told(result: Identification, words: str) -> list[Problem]:
    return [p for p in result.problems if words in p.got]


def test_a_residual_that_is_not_white():
    (problem,) = told(found(drift=2.0, second_estimator=False), "times white noise's share")
    assert "load_torque = true under [identify]" in problem.remedy
    assert told(found(), "times white noise's share") == []


def test_power_in_the_lower_tenth():
    rng = np.random.default_rng(1)
    white = rng.standard_normal(50000)
    assert low_frequency_excess(white) == pytest.approx(1.0, abs=0.1)
    assert low_frequency_excess(np.diff(white)) < 0.1
    assert low_frequency_excess(np.convolve(white, np.ones(10) / 10.0)) > 5.0


def test_too_low_a_resolution():
    (problem,) = told(found(bits=11, second_estimator=False), "in a speed that varies by")
    assert problem.where == "speed_motor" and "finer encoder" in problem.remedy
    assert told(found(), "in a speed that varies by") == []


def test_values_from_coarse_counts_are_right_or_not_told():
    """Rows are joined; without that 12 bit gave values that were 50 to 100 % wrong."""
    result = found(bits=12)
    for name, (low, high) in result.intervals.items():
        assert low <= getattr(PLANT, name) <= high, name
    assert result.prediction.time.size < 20000


def test_only_the_total_inertia_is_told_where_no_rows_can_be_joined():
    """Counts of 9 bit: joining six rows leaves too much of the speed's variation."""
    result = found(bits=9, second_estimator=False)
    (low, high), *others = (result.intervals[name] for name in result.sources if name in result.intervals)
    assert result.sources["inertia_total"] == "identified" and others == []
    assert low <= PLANT.inertia_total <= high
    assert any("Nothing is identified" in p.remedy for p in result.problems)
    assert result.drivetrain.stiffness == pytest.approx(PLANT.stiffness)


@pytest.mark.usefixtures("short_search")
def test_the_second_estimator_tells_from_coarse_counts():
    """It takes the counts as angles: their rounding does not add up."""
    result = found(bits=10)
    assert {"inertia_motor", "inertia_load"} <= set(result.intervals)
    for name, (low, high) in result.intervals.items():
        assert low <= getattr(PLANT, name) <= high, name
    assert not any("Nothing is identified" in p.remedy for p in result.problems)


def test_a_start_far_off():
    alone = found(factor=0.33, second_estimator=False)
    (problem,) = [p for p in alone.problems if p.where == "stiffness"]
    assert "nameplate" in problem.expected and "Check the value under [nameplate]" in problem.remedy
    assert [p for p in found().problems if p.where == "stiffness"] == []


def fit(cost: float, **factors: float) -> Fit:
    theta = to_theta([getattr(PLANT, n) * factors.get(n, 1.0) for n in NAMES], DT)
    return Fit(theta, np.zeros(1), cost, 1, True)


def test_a_second_minimum_is_far_away_and_nearly_as_good():
    best, near, worse = fit(1.0), fit(1.01, stiffness=1.1), fit(1.5, backlash=3.0)
    assert rival([near, best, worse]) is None
    other = fit(1.05, backlash=2.0, viscous=9.0)
    assert rival([worse, other, best]) is other.theta
    assert rival([best, fit(1.0, viscous=9.0)]) is None, "what is poorly known anyway does not count"


def test_a_second_minimum_is_told_with_its_values():
    values = {n: getattr(PLANT, n) for n in NAMES}
    problem = second_minimum(PLANT, {**values, "backlash": 0.024})
    assert "backlash 0.024 rad" in problem.got and "stiffness" not in problem.got
    assert "reversals" in problem.remedy


def test_a_recording_that_takes_too_much_memory_is_refused_before_the_work(monkeypatch: pytest.MonkeyPatch):
    """Ten hours at 10 kHz would end the process after hours, and nobody would know why."""
    monkeypatch.setenv(VARIABLE, "10MB")
    torque = lm.signals.excitation(2.0, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    recording = lm.Recording(DT * np.arange(20_000), {"torque_motor": torque, "speed_motor": torque})
    with pytest.raises(
        InvalidInput, match=r"20000 rows.*12 MB.*window = \[start, stop\].*--memory-limit 12MB"
    ):
        lm.identify(recording, start=PLANT)


def test_the_memory_that_is_asked_for_is_enough():
    torque = lm.signals.excitation(2.0, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(PLANT, torque_motor=torque, dt=DT)
    recording = run.only("torque_motor").with_signals("measured", speed_motor=speed_from_counts(run, 1e-6))
    found()  # what is imported on the way does not count
    tracemalloc.start()
    try:
        lm.identify(recording, start=PLANT, second_estimator=False)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert 0.3 * MEMORY < peak / len(recording) < MEMORY


@pytest.mark.parametrize(
    ("used", "nameplate", "words"),
    [
        (0.01 * (1.0 + 1e-12), 0.01, "The nameplate's 0.01 rad is used"),
        (0.0, 0.0, "lacks it: 0 rad"),
        (0.02, 0.01, "the likeliest value, 0.02 rad, which may be far off"),
    ],
)
def test_what_is_taken_for_an_unexcited_parameter(used, nameplate, words):
    """A user who gave no backlash is not told of the nameplate's."""
    assert words in not_excited("backlash", used, nameplate).remedy

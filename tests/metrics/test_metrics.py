"""Metrics against closed-form answers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion import metrics
from lostmotion.errors import InvalidInput
from lostmotion.events import Event, Events


def second_order(time: np.ndarray, omega: float, zeta: float, step_time: float = 0.0) -> np.ndarray:
    """Unit step response of omega²/(s² + 2·zeta·omega·s + omega²), zeta < 1."""
    t = np.maximum(time - step_time, 0.0)
    damped = omega * math.sqrt(1.0 - zeta**2)
    return 1.0 - np.exp(-zeta * omega * t) * (
        np.cos(damped * t) + zeta / math.sqrt(1.0 - zeta**2) * np.sin(damped * t)
    )


def smooth(time: np.ndarray) -> np.ndarray:
    return np.sin(40.0 * time) + 0.3 * np.sin(613.0 * time + 0.4) + 2.0 * time


def test_rmse_largest_error_and_range():
    a, b = np.array([1.0, 2.0, 3.0, 4.0]), np.array([1.0, 2.0, 3.0, 0.0])
    assert metrics.rmse(a, b) == 2.0
    assert metrics.largest_error(a, b) == 4.0
    assert metrics.signal_range(a) == 3.0


def test_lag_of_equal_signals_is_zero():
    time = np.arange(5000) * 1e-4
    assert metrics.lag(smooth(time), smooth(time), 1e-4) == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("late", [-0.0123, -0.00034, 2e-5, 0.00036, 0.0071])
def test_lag_between_samples_with_offset_and_noise(late):
    dt = 1e-4
    time = np.arange(20_000) * dt
    noise = 0.02 * np.random.default_rng(3).standard_normal((2, time.size))
    found = metrics.lag(smooth(time - late) + 5.0 + noise[0], smooth(time) + noise[1], dt)
    assert found == pytest.approx(late, abs=0.1 * dt)


def test_lag_without_noise_is_exact_to_a_thousandth_of_a_sample():
    dt = 1e-4
    time = np.arange(20_000) * dt
    assert metrics.lag(smooth(time - 0.00036), smooth(time), dt) == pytest.approx(0.00036, abs=1e-3 * dt)


@pytest.mark.parametrize(
    ("estimate", "truth"),
    [
        (np.zeros(100), np.arange(100.0)),
        (np.arange(100.0), np.ones(100)),
        (np.arange(4.0), np.arange(4.0)),
        (smooth(np.arange(4000) * 1e-4), smooth(np.arange(4000) * 1e-4 - 0.08)),  # later than max_lag
    ],
)
def test_lag_is_none_where_undefined(estimate, truth):
    assert metrics.lag(estimate, truth, 1e-4) is None


def test_compare():
    time = np.arange(4000) * 1e-4
    truth = smooth(time)
    found = metrics.compare(truth + 0.1, truth, 1e-4)
    span = truth.max() - truth.min()
    assert found["lag"] == pytest.approx(0.0, abs=1e-7)
    assert found["rmse"] == pytest.approx(0.1)
    assert found["max"] == pytest.approx(0.1)
    assert found["range"] == span
    assert found["rmse_of_range"] == pytest.approx(0.1 / span)


def test_compare_with_a_constant_truth_has_none_and_no_nan():
    found = metrics.compare(np.ones(50), np.zeros(50), 1e-3)
    assert found == {"rmse": 1.0, "range": 0.0, "max": 1.0, "lag": None, "rmse_of_range": None}


@pytest.mark.parametrize("bad", [np.array([1.0, np.nan]), np.ones((2, 2)), np.ones(3), np.array([])])
def test_misuse_is_refused(bad):
    with pytest.raises(InvalidInput):
        metrics.rmse(bad, np.ones(2))


@pytest.mark.parametrize("zeta", [0.2, 0.5, 0.7])
@pytest.mark.parametrize(("before", "after"), [(-2.0, 2.0), (3.0, 1.0)])
def test_second_order_step(zeta, before, after):
    omega, step_time = 60.0, 0.2137
    time = np.arange(30_000) * 1e-4
    response = before + (after - before) * second_order(time, omega, zeta, step_time)
    found = metrics.step_metrics(time, response, step_time, before, after, torque=7.0 * np.cos(time * 50.0))
    overshoot = 100.0 * math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2))
    assert found.overshoot == pytest.approx(overshoot, abs=0.01)
    fine = np.linspace(0.0, 2.0, 2_000_001)
    progress = second_order(fine, omega, zeta)
    rise = fine[np.argmax(progress >= 0.9)] - fine[np.argmax(progress >= 0.1)]
    settled = fine[np.flatnonzero(np.abs(progress - 1.0) > 0.02)[-1] + 1]
    assert found.rise_time == pytest.approx(rise, abs=3e-6)
    assert found.settling_time == pytest.approx(settled, abs=3e-6)
    assert found.steady_error == pytest.approx(0.0, abs=1e-6)
    assert found.peak_torque == pytest.approx(7.0, rel=1e-5)


def test_crossings_are_interpolated():
    time = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    signal = np.array([0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0])
    found = metrics.step_metrics(time, signal, 1.0, 0.0, 1.0)
    assert found.rise_time == pytest.approx(1.6)
    assert found.settling_time == pytest.approx(1.96)
    assert found.overshoot == 0.0
    assert found.peak_torque is None


def test_no_overshoot_is_zero_and_a_steady_error_never_settles():
    time = np.arange(2000) * 1e-3
    signal = -2.0 + 3.6 * (1.0 - np.exp(-time / 0.02))
    found = metrics.step_metrics(time, signal, 0.0, -2.0, 2.0)
    assert found.overshoot == 0.0
    assert found.settling_time is None
    assert found.steady_error == pytest.approx(0.1, abs=1e-6)


def test_a_response_that_never_comes_has_no_rise_time():
    found = metrics.step_metrics(np.arange(100) * 1e-3, np.zeros(100), 0.01, 0.0, 1.0)
    assert found.as_dict() == {
        "overshoot": 0.0,
        "rise_time": None,
        "settling_time": None,
        "peak_torque": None,
        "steady_error": 1.0,
    }


def test_a_pulse_is_judged_up_to_the_step_back():
    time = np.arange(3000) * 1e-3
    signal = second_order(time, 40.0, 0.5, 0.5) - 5.0 * second_order(time, 40.0, 0.5, 2.0)
    found = metrics.step_metrics(time, signal, 0.5, 0.0, 1.0, stop_time=2.0)
    assert found.settling_time is not None
    assert found.steady_error < 1e-4


def test_torque_before_the_step_does_not_count():
    time = np.arange(1000) * 1e-3
    torque = np.where(time < 0.5, 99.0, -3.0)
    found = metrics.step_metrics(time, second_order(time, 40.0, 0.5, 0.5), 0.5, 0.0, 1.0, torque=torque)
    assert found.peak_torque == 3.0


@pytest.mark.parametrize(("step_time", "after"), [(0.5, 0.0), (9.0, 1.0)])
def test_step_metrics_misuse(step_time, after):
    with pytest.raises(InvalidInput):
        metrics.step_metrics(np.arange(1000) * 1e-3, np.zeros(1000), step_time, 0.0, after)


def crossing(events, motor, load, **changes):
    time = np.arange(1000) * 1e-3
    given = {"step_time": 0.1, "before": -2.0, "after": 2.0, **changes}
    return metrics.crossing_metrics(time, motor(time), load(time), Events.of(events), **given)


def ramp(time):
    return np.clip(-2.0 + 40.0 * (time - 0.1), -2.0, 2.0)


def test_a_crossing_by_hand():
    events = [
        Event(0.05, "separation", "shaft 3", -9.0), Event(0.06, "impact", "shaft 3", -9.0),
        Event(0.103, "separation", "shaft 3", 0.1), Event(0.104, "impact", "shaft 1", 7.0),
        Event(0.108, "impact", "shaft 3", 2.5), Event(0.120, "separation", "shaft 3", -0.5),
        Event(0.121, "impact", "shaft 3", 0.4), Event(0.15, "stick", "friction 4", 0.0),
    ]  # fmt: skip
    found = crossing(
        events,
        motor=lambda t: ramp(t) + np.where(t > 0.19, 0.3 * np.sin(2.0 * np.pi * 100.0 * t), 0.0),
        load=ramp,
        shaft=3,
    )
    assert found.arrival_time == pytest.approx(0.09, abs=1e-9)
    assert found.impacts == 2
    assert found.impact_speed == 2.5
    assert found.lash_time == pytest.approx(0.006, abs=1e-12)
    assert found.oscillation == pytest.approx(0.3 / np.sqrt(2.0), rel=1e-2)
    assert found.swing == pytest.approx(0.3 * np.sin(0.4 * np.pi), rel=1e-3)
    assert found.motor_overshoot == pytest.approx(0.3 * np.sin(0.4 * np.pi), rel=1e-3)
    assert found.motor_deviation == pytest.approx(0.12 + 0.3 * np.sin(0.6 * np.pi), rel=1e-6)


@pytest.mark.parametrize(
    "events, apart",
    [
        ([], 0.0),
        ([Event(0.25, "impact", "shaft 1", 1.0)], 0.15),
        ([Event(0.25, "separation", "shaft 1", 1.0)], 0.25),
        ([Event(0.6, "separation", "shaft 1", 1.0)], 0.0),
    ],
)
def test_time_in_the_gap_counts_from_the_step_to_the_end(events, apart):
    found = crossing(events, ramp, ramp, stop_time=0.5)
    assert found.lash_time == pytest.approx(apart, abs=1e-12)


def test_a_load_that_never_arrives_has_no_oscillation():
    found = crossing([], ramp, lambda t: -2.0 + 0.0 * t)
    assert found.arrival_time is None and found.oscillation is None and found.impact_speed == 0.0
    assert found.motor_deviation is None


def test_recovery_from_a_disturbance():
    time = np.arange(1000) * 1e-3
    error = np.where(time < 0.2, 5.0, -0.8 * np.exp(-(time - 0.2) / 0.02))
    found = metrics.recovery(time, error, 0.2, 0.08)
    assert found.largest_error == pytest.approx(0.8)
    assert found.time == pytest.approx(0.02 * math.log(10.0), abs=1e-5)
    assert metrics.recovery(time, error + 1.0, 0.2, 0.08).time is None
    with pytest.raises(InvalidInput, match="recovery"):
        metrics.recovery(time, error, 0.2, 0.0)

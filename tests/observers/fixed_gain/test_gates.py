"""Unknown load torque, and the correction that the gap closes."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.observers import kalman
from lostmotion.observers.fixed_gain.gates import LARGEST_CORRECTION, OPEN_AT
from lostmotion.simulation import simulate

DT = 1e-4


def rms(error):
    return float(np.sqrt(np.mean(np.square(error))))


def noise(seconds, seed, mean=0.0):
    return mean + 10.0 * np.random.default_rng(seed).normal(size=round(seconds / DT))


def test_an_unknown_load_torque_is_found_and_no_longer_hurts():
    u = noise(3.0, 1, mean=6.0)
    told = np.where(np.arange(u.size) < u.size // 3, 0.0, -3.0)
    recording = simulate(PAPER, dt=DT, torque_motor=u, torque_load=told)
    data = recording.only("torque_motor", "speed_motor")
    with_state, without = (kalman(PAPER, dt=DT, load_torque=b).run(data) for b in (True, False))
    settled = slice(2 * u.size // 3, None)
    found = with_state["torque_load_estimated"][settled]
    assert np.mean(found) == pytest.approx(-3.0, abs=0.05)
    assert rms(found + 3.0) < 0.5
    errors = [
        rms((o["speed_load_estimated"] - recording["speed_load"])[settled]) for o in (with_state, without)
    ]
    assert errors[0] < 0.1 * errors[1]
    assert "torque_load_estimated" not in without


def test_load_torque_is_zero_where_there_is_none():
    recording = simulate(PAPER, dt=DT, torque_motor=noise(2.0, 2, mean=5.0))
    found = kalman(PAPER, dt=DT, load_torque=True).run(recording)
    assert rms(found["torque_load_estimated"][10_000:]) < 0.1


def scheduled(contact="viscoelastic", **options):
    return kalman(PAPER.with_contact(contact), dt=DT, contact_scheduling=True, **options)


def run_from(observer, state, speed, torque=0.0, n=50):
    start = np.zeros(len(observer.states))
    start[:3] = state
    inputs = {name: np.zeros(n) for name in observer.inputs}
    inputs |= {"torque_motor": np.full(n, torque), "speed_motor": np.full(n, speed)}
    return observer.run(inputs, state=start)


def test_in_the_gap_the_load_is_predicted_not_corrected():
    plain, gated = (kalman(PAPER, dt=DT, contact_scheduling=b) for b in (False, True))
    # Both believe that they are in the gap, with the load sliding at 1 rad/s; the motor speed says +0.5 rad/s.
    start, measured = (0.0, 1.0, 1.0), 1.5
    moved = [run_from(o, start, measured)["speed_load_estimated"] for o in (plain, gated)]
    slowing = 1.0 - (2.0 + 0.0175) / 0.111 * DT * np.arange(50)
    np.testing.assert_allclose(moved[1], slowing, atol=1e-4)
    assert np.max(np.abs(moved[0] - slowing)) > 0.01
    # The motor speed is still followed, at √1000 1/s (process density 1000 beside a measurement density of 1).
    motor = run_from(gated, start, measured)["speed_motor_estimated"]
    np.testing.assert_allclose(motor, 1.5 - 0.5 * np.exp(-np.sqrt(1000.0) * DT * np.arange(50)), atol=0.01)


@pytest.mark.parametrize("measured", [("speed_motor",), ("torque_shaft", "speed_motor")])
def test_in_contact_it_is_the_plain_observer(measured):
    plain, gated = (kalman(PAPER, dt=DT, measured=measured, contact_scheduling=b) for b in (False, True))
    # 20 Nm drive without a break: the estimates stay in contact although the measurement is off.
    recording = simulate(PAPER, dt=DT, torque_motor=np.full(6000, 20.0))
    settled = recording.window(0.3)
    assert np.all(settled["torque_shaft"] > 5.0)
    data = {name: settled[name] for name in ("torque_motor", *measured)}
    data["speed_motor"] = data["speed_motor"] + 0.2
    start = np.zeros(len(plain.states))
    start[:3] = [settled[n][0] for n in ("twist", "speed_motor", "speed_load")]
    a, b = (o.run(data, state=start) for o in (plain, gated))
    assert np.min(a["torque_shaft_estimated"]) > OPEN_AT
    for name in plain.outputs:
        np.testing.assert_allclose(b[name], a[name], rtol=1e-9, atol=1e-9)


def test_an_outlier_counts_no_more_than_the_largest_innovation():
    # One sample, in contact: the gain in the gap leaves the load alone, so the clipped part is all that moves it.
    def load_after(jump):
        return run_from(scheduled(), (0.02, 0.0, 0.0), jump, n=2)["speed_load_estimated"][1]

    most, rest = LARGEST_CORRECTION["speed_motor"], load_after(0.0)
    # The gain in the gap is nought up to the rounding of its Riccati equation, 1e-12.
    assert load_after(1e4) == pytest.approx(load_after(most), rel=1e-6)
    assert load_after(0.5 * most) - rest == pytest.approx(0.5 * (load_after(most) - rest), rel=1e-6)
    assert abs(load_after(most) - rest) > 0.1


def test_without_backlash_there_is_nothing_to_schedule():
    plant = PAPER.with_parameters(backlash=0.0)
    plain, gated = (kalman(plant, dt=DT, contact_scheduling=b) for b in (False, True))
    assert plain.to_dict() == gated.to_dict()


@pytest.mark.parametrize("contact", ["viscoelastic", "dead_zone"])
@pytest.mark.parametrize("options", [{}, {"load_torque": True}, {"speed_from_counts": True}])
def test_it_finds_a_wrong_start(contact, options):
    recording = simulate(PAPER.with_contact(contact), dt=DT, torque_motor=noise(3.0, 5, mean=5.0))
    observer = scheduled(contact, **options)
    start = np.zeros(len(observer.states))
    start[:3] = [-0.008, 3.0, -2.0]
    found = observer.run(recording, state=start).window(2.0)
    truth = recording.window(2.0)
    for signal in ("speed_load", "torque_shaft"):
        assert rms(found[f"{signal}_estimated"] - truth[signal]) < 0.03 * np.ptp(truth[signal])

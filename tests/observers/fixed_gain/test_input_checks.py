"""Fixed-gain observers predict through bad samples, flag them, and are soon themselves again."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion import rig
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers import disturbance_observer, h_infinity, kalman
from lostmotion.observers.fixed_gain.input_checks import LARGEST_INNOVATION
from lostmotion.signals import excitation
from lostmotion.simulation import simulate

DT = 1e-4
SECONDS = 3.0
TORQUE = excitation(SECONDS, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
RIGS = [rig.record(seed, torque_motor=TORQUE, channels=("speed_motor", "torque_shaft")) for seed in (1, 2, 3)]
PLANTS = [Drivetrain.two_mass(**truth.parameters) for _, truth in RIGS]
(RECORDING, TRUTH), PLANT = RIGS[0], PLANTS[0]
#: One burst of bad samples every 0.3 s, 20 ms long.
STARTS, LENGTH = range(6000, round(SECONDS / DT) - 1500, 3000), 200

BOTH = ("torque_shaft", "speed_motor")
MAKERS = {
    "kalman": kalman,
    "kalman, load torque": partial(kalman, load_torque=True),
    "kalman, scheduled": partial(kalman, contact_scheduling=True),
    "kalman on both": partial(kalman, measured=BOTH),
    "H infinity": h_infinity,
    "H infinity, load torque": partial(h_infinity, load_torque=True),
    "disturbance_observer": disturbance_observer,
}
LAWS = {
    name: [make(plant, dt=DT, speed_from_counts=True) for plant in PLANTS] for name, make in MAKERS.items()
}
OBSERVERS = {name: laws[0] for name, laws in LAWS.items()}
every = pytest.mark.parametrize("law", OBSERVERS.values(), ids=OBSERVERS.keys())


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def broken(values, fault, size=5.0, starts=STARTS, length=LENGTH):
    """A signal with faults, which samples are bad, and which count: 20 ms from 50 ms after the signal is back."""
    shown, bad, after = values.copy(), np.zeros(values.size, dtype=bool), np.zeros(values.size, dtype=bool)
    if fault == "dropped":
        bad = np.random.default_rng(1).random(values.size) < 0.05
        shown[bad] = np.nan
        return shown, bad, ~bad & (np.arange(values.size) > starts[0])
    for i, start in enumerate(starts):
        burst = slice(start, start + length)
        bad[burst] = True
        back = start + length + round(0.05 * length / 0.02)
        after[back : back + length] = True
        if fault == "missing":
            shown[burst] = np.nan
        elif fault in ("frozen", "zero"):
            shown[burst] = shown[start - 1] if fault == "frozen" else 0.0
        else:
            shown[burst] += (-1) ** i * size
    return shown, bad, after


def compared(runs, signal, fault, size=5.0, **bursts):
    """Error after the faults over the same without them, for each estimate; share of bad and of good samples flagged.

    ``runs``: for each rig the observer, its inputs, and the true signals.
    """
    errors, flagged = {}, ([], [])
    for law, data, truth in runs:
        clean = law.run(data)
        shown, bad, after = broken(data[signal], fault, size, **bursts)
        found = law.run({**{name: data[name] for name in law.inputs}, signal: shown})
        for name, exact in truth.items():
            row = [np.square((run[f"{name}_estimated"] - exact)[after]) for run in (found, clean)]
            errors.setdefault(name, []).append(row)
        for share, rows in zip(flagged, (bad, ~bad), strict=True):
            share.append(found["input_fault"][rows])
    ratios = [
        np.sqrt(np.sum([f for f, _ in rows]) / np.sum([c for _, c in rows])) for rows in errors.values()
    ]
    return max(ratios), *(float(np.mean(np.concatenate(share))) for share in flagged)


def on_the_rigs(name):
    signals = ("speed_load", "torque_shaft")
    return [
        (law, recording.only(*law.inputs), {n: truth.signals[n] for n in signals})
        for law, (recording, truth) in zip(LAWS[name], RIGS, strict=True)
    ]


def turns_fast(data, start):
    """Whether the motor's speed is well beyond the largest innovation that its check accepts."""
    return abs(data["speed_motor"][start - 1]) > 2.0 * LARGEST_INNOVATION["speed_motor"]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("fault", ["missing", "frozen", "zero", "jump", "dropped"])
def test_bad_samples_of_the_motor_speed_are_predicted_through_flagged_and_soon_forgotten(name, fault):
    runs, starts = on_the_rigs(name), STARTS
    if name == "disturbance_observer" and fault == "zero":
        # It soon expects whatever it is shown: zero after a small jump looks like standstill to it.
        starts = [start for start in STARTS if all(turns_fast(data, start) for _, data, _ in runs)]
        assert len(starts) >= 3
    ratio, flagged, wrongly = compared(runs, "speed_motor", fault, starts=starts)
    assert ratio < 1.5
    if name == "disturbance_observer" and fault == "jump":
        return  # its own errors of late are nearly as large
    assert flagged > {"frozen": 0.9, "zero": 0.97}.get(fault, 0.999)
    assert wrongly < (0.03 if name == "disturbance_observer" else 1e-3)


@pytest.mark.parametrize("fault", ["missing", "frozen", "zero", "jump", "dropped"])
def test_the_torque_sensor_may_fail_too(fault):
    ratio, flagged, wrongly = compared(on_the_rigs("kalman on both"), "torque_shaft", fault, 60.0)
    assert ratio < 1.5
    assert flagged > (0.8 if fault in ("frozen", "zero") else 0.999)
    assert wrongly < 1e-3


@pytest.mark.parametrize("name", LAWS)
def test_a_missing_motor_torque_is_told_from_the_motor_speed(name):
    """With the last torque held, ``kalman`` had 11.9."""
    ratio, flagged, wrongly = compared(on_the_rigs(name), "torque_motor", "missing")
    assert ratio < 1.5
    assert flagged == 1.0 and wrongly == 0.0


@pytest.mark.parametrize("name, most", [("kalman", 4.0), ("kalman on both", 10.0), ("H infinity", 1.5)])
def test_a_coarse_encoder_is_not_taken_for_torque(name, most):
    """With 14 bit, the torque that brings the motor to each sample's speed would cost 21.8, 61 and 4.3 times."""
    step, runs = 2.0 * np.pi / 2**14 / DT, []
    for law, data, truth in on_the_rigs(name):
        angle = np.cumsum(data["speed_motor"]) * DT
        counts = np.diff(np.floor(angle / (step * DT)), prepend=0.0) * step
        runs.append((law, data.with_signals("measured", speed_motor=counts), truth))
    ratio, flagged, wrongly = compared(runs, "torque_motor", "missing")
    assert ratio < most
    assert flagged == 1.0 and wrongly == 0.0


@pytest.mark.parametrize("lag", [0.0, 3e-4, 5e-3])
@pytest.mark.parametrize("averaged", [False, True])
@pytest.mark.parametrize("dt", [1e-4, 1e-3])
def test_the_torque_that_follows_the_motor_speed_is_stable(lag, averaged, dt):
    """The torque put into the law: the motor follows soon, and the load's swing dies out."""
    plant = PLANT.with_parameters(lag=lag, backlash=0.0, coulomb=0.0)
    law = kalman(plant, dt=dt, speed_from_counts=averaged)
    row = [check.input for check in law.checks].index("torque_motor")
    poles = replace(law, A=law.A + law.B[:, :1] @ law.P[[row]]).poles()
    swing = abs(poles - 1.0) < 0.3
    assert max(abs(poles[swing])) < 1.0
    assert max(abs(poles[~swing]), default=0.0) < 0.9


@pytest.mark.parametrize("fault", ["zero", "frozen"])
def test_a_sensor_that_hangs_for_longer_costs_no_more_than_one_that_is_missing(fault):
    """60 ms; believed after 30 ms, zeros had 15 times the error of missing samples."""
    ratios = {f: compared(on_the_rigs("kalman"), "speed_motor", f, length=600)[0] for f in ("missing", fault)}
    assert ratios[fault] < 1.1 * ratios["missing"]


def test_with_all_signals_missing_the_torque_holds_its_last_value():
    law, data = OBSERVERS["kalman"], {n: RECORDING[n].copy() for n in OBSERVERS["kalman"].inputs}
    gone = slice(6000, 6200)
    data["speed_motor"][gone] = np.nan
    held = {n: values.copy() for n, values in data.items()}
    data["torque_motor"][gone], held["torque_motor"][gone] = np.nan, held["torque_motor"][5999]
    found, wanted = law.run(data), law.run(held)
    for name in law.outputs:
        np.testing.assert_array_equal(found[name], wanted[name])


def test_a_short_and_large_jump_does_not_make_it_deaf_to_small_ones():
    """Zero at 1 to 4 rad/s, soon after jumps by 200 rad/s."""
    law, speed = OBSERVERS["kalman on both"], RECORDING["speed_motor"].copy()
    slow = [k for k in range(8000, len(speed) - 400, 100) if np.all(abs(abs(speed[k : k + 20]) - 2.5) < 1.5)]
    slow = [k for i, k in enumerate(slow) if i == 0 or k - slow[i - 1] > 500]
    bad = np.zeros(speed.size, dtype=bool)
    for k in slow:
        speed[k - 400 : k - 380] += 200.0
        bad[k - 400 : k - 380] = bad[k : k + 20] = True
        speed[k : k + 20] = 0.0
    found = law.run({**{name: RECORDING[name] for name in law.inputs}, "speed_motor": speed})["input_fault"]
    assert len(slow) == 5
    assert np.mean(found[bad]) > 0.95 and np.mean(found[~bad]) < 1e-3


@every
def test_good_samples_are_believed_to_the_last_bit(law):
    data = RECORDING.only(*law.inputs)
    checked, plain = law.run(data), law.without_checks().run(data)
    assert not np.any(checked["input_fault"])
    for name in law.outputs:
        np.testing.assert_array_equal(checked[name], plain[name])


@pytest.mark.parametrize("bits", [10, 12, 14])
def test_a_coarse_encoder_is_no_fault(bits):
    step = 2.0 * np.pi / 2**bits / DT
    angle = np.cumsum(TRUTH.signals["speed_motor"]) * DT
    counts = np.diff(np.floor(angle / (step * DT)), prepend=0.0) * step
    data = {"torque_motor": RECORDING["torque_motor"], "speed_motor": counts}
    checked, plain = (law.run(data) for law in (OBSERVERS["kalman"], OBSERVERS["kalman"].without_checks()))
    assert np.mean(checked["input_fault"]) < 1e-3
    errors = [
        rms((run["speed_load_estimated"] - TRUTH.signals["speed_load"])[3000:]) for run in (checked, plain)
    ]
    assert errors[0] < 1.02 * errors[1]


def test_a_wrong_start_is_corrected_at_once():
    recording = simulate(PLANT, dt=DT, torque_motor=TORQUE[:10_000], state=(0.0, 60.0, 60.0))
    law = OBSERVERS["kalman"]
    checked, plain = law.run(recording), law.without_checks().run(recording)
    assert rms((checked["speed_load_estimated"] - recording["speed_load"])[:500]) > 10.0
    np.testing.assert_array_equal(checked["speed_load_estimated"], plain["speed_load_estimated"])


def test_a_lasting_offset_is_believed_after_the_hold_time():
    """What the sensor says for longer than 30 ms is right: a wrong observer is never locked out."""
    speed = RECORDING["speed_motor"] + np.where(np.arange(len(RECORDING)) < 10_000, 0.0, 8.0)
    found = OBSERVERS["kalman"].run({"torque_motor": RECORDING["torque_motor"], "speed_motor": speed})
    fault = found["input_fault"]
    assert np.all(fault[10_000:10_300] == 1.0) and not np.any(fault[10_300:10_600])
    assert rms((found["speed_motor_estimated"] - speed)[-5000:]) < 1.0


def test_a_standing_drive_is_not_frozen():
    still = {"torque_motor": np.zeros(5000), "speed_motor": np.zeros(5000)}
    assert not np.any(OBSERVERS["kalman"].run(still)["input_fault"])


wild = st.one_of(
    st.sampled_from([np.nan, np.inf, -np.inf, 0.0, -0.0, 1e30, -1e30, 1e31, 5e-324, 1.7e308, 5.0]),
    st.floats(allow_nan=True, allow_infinity=True),
)


@every
@settings(max_examples=30, deadline=None, derandomize=True)
@given(data=st.data())
def test_never_a_nan_for_any_input(law, data):
    rows = data.draw(
        st.lists(st.tuples(st.tuples(*[wild] * len(law.inputs)), st.integers(1, 400)), min_size=1, max_size=8)
    )
    inputs = np.concatenate([np.ones((1, len(law.inputs))), *(np.tile(row, (n, 1)) for row, n in rows)])
    found = law.run({name: inputs[:, i] for i, name in enumerate(law.inputs)})
    for name in found:
        assert np.all(np.isfinite(found[name])), name
    assert np.all(np.isfinite(found.final_state["state"]))


@pytest.mark.parametrize("limits", [{"speed_motor": 0.0}, {"speed_load": 1.0}, {"speed_motor": float("nan")}])
def test_misuse_of_the_limits(limits):
    with pytest.raises(InvalidInput, match=r"limit|largest_innovation"):
        kalman(PLANT, dt=DT, largest_innovation=limits)

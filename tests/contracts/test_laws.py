"""What every observer and controller must keep: one arithmetic everywhere, JSON, and no NaN that lives on."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_law import COMPILER, c_run, numba_run, python_run, random_inputs
from table_i import PAPER

from lostmotion.controllers import (
    active_damping,
    flatness,
    h_infinity,
    lqi,
    notch,
    pi,
    pole_placement,
    predictive,
    sliding_mode,
    soft_landing,
    speed_course,
    super_twisting,
    torque_ramp,
)
from lostmotion.curves import PiecewiseLinear
from lostmotion.drivetrain import Friction
from lostmotion.observers import disturbance_observer, kalman, shaft_torque
from lostmotion.observers import h_infinity as h_infinity_observer
from lostmotion.observers.fixed_gain.gates import POSITIVE_PART
from lostmotion.observers.model import SENSORS
from lostmotion.systems import DiscreteSystem, connect, minimum, one_sample_delay, rate_limit

ONE_SIDED = replace(PAPER, frictions=(Friction(0.3, 0.001), Friction((2.5, 0.0), 0.0175)))


def observer_1_with_pole_placement() -> DiscreteSystem:
    observer = kalman(PAPER, dt=1e-4)
    controller = pole_placement(PAPER, dt=1e-4, torque_limit=73.5)
    return connect(
        [observer, controller], inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",)
    )


def soft_landing_behind_lqi() -> DiscreteSystem:
    plant = PAPER.with_parameters(lag=3e-4)
    observer = kalman(plant, dt=1e-4, load_torque=True, speed_from_counts=True)
    speed = lqi(plant, dt=1e-4, largest_error=2.0, largest_torque=73.5, torque_limit=73.5)
    limiter = soft_landing(plant, dt=1e-4, contact_speed=0.6, torque_limit=73.5)
    return connect(
        [
            observer.renamed({"torque_motor": "torque_motor_acting"}),
            speed.renamed({"torque_motor": "torque_wished"}),
            limiter,
        ],
        inputs=("speed_reference", "speed_motor", "torque_motor_acting"),
        outputs=("torque_motor",),
    )


OBSERVERS = {
    **{f"kalman on {sensor}": kalman(PAPER, measured=(sensor,), dt=1e-4) for sensor in SENSORS},
    "kalman on all": kalman(PAPER, measured=SENSORS, dt=1e-4),
    "observer 2": kalman(PAPER, measured=("torque_shaft", "speed_motor"), dt=1e-4),
    "kalman at 1 ms": kalman(PAPER, dt=1e-3),
    "kalman, dead zone": kalman(PAPER.with_contact("dead_zone"), dt=1e-4),
    "kalman, linear": kalman(PAPER.with_parameters(backlash=0.0, coulomb=0.0), dt=1e-4),
    "kalman, lag": kalman(PAPER.with_parameters(lag=5e-4), dt=1e-4, speed_from_counts=True),
    "kalman, load torque": kalman(PAPER, dt=1e-4, load_torque=True),
    "kalman, guarded": kalman(
        PAPER, measured=("speed_motor", "torque_shaft"), dt=1e-4, largest_innovation={"speed_motor": 4.0}
    ),
    "kalman, scheduled": kalman(
        PAPER, measured=("torque_shaft", "speed_motor"), dt=1e-4, contact_scheduling=True, load_torque=True
    ),
    "kalman, injection": kalman(PAPER, dt=1e-4, injection={"speed_motor": 1.4e-3}),
    "kalman, injection of both sensors": kalman(
        PAPER.with_contact("dead_zone"),
        measured=("torque_shaft", "speed_motor"),
        dt=1e-4,
        injection={"torque_shaft": 1.4e-4, "speed_motor": 1e-4},
    ),
    "H infinity": h_infinity_observer(PAPER.with_parameters(lag=3e-4), dt=1e-4, speed_from_counts=True),
    "shaft torque": shaft_torque(6285.896, dt=1e-3, torque_delay=4e-4),
    "disturbance observer": disturbance_observer(
        PAPER.with_parameters(lag=3e-4), dt=1e-4, speed_from_counts=True
    ),
    "kalman, one-sided friction": kalman(ONE_SIDED, measured=("angle_motor", "speed_load"), dt=2e-4),
}
#: What the laws with weights are asked for.
WISHES = {"dt": 1e-4, "largest_error": 2.0, "largest_torque": 73.5}
CONTROLLERS = {
    "pi": pi(dt=1e-4),
    "pi with limit": pi(dt=1e-4, torque_limit=20.0),
    "pi with filter and friction": pi(dt=1e-4, filter_time=0.02, friction_of=ONE_SIDED),
    "pi with filtered speed": pi(dt=1e-4, torque_limit=20.0, speed_filter_time=5e-3),
    "pi with all": pi(
        dt=1e-4,
        torque_limit=20.0,
        filter_time=0.02,
        speed_filter_time=5e-3,
        friction_of=ONE_SIDED,
        realised_torque=True,
    ),
    "pole placement": pole_placement(PAPER, dt=1e-4),
    "pole placement with limit": pole_placement(PAPER, dt=1e-4, torque_limit=73.5),
    "pole placement, by reference": pole_placement(
        ONE_SIDED, dt=1e-4, torque_limit=73.5, friction_compensation="reference"
    ),
    "pole placement, uncompensated": pole_placement(PAPER, dt=1e-4, friction_compensation="none"),
    "lqi": lqi(PAPER, **WISHES),
    "lqi with limit, lag and friction of the motor": lqi(
        ONE_SIDED.with_parameters(lag=3e-4), **WISHES, torque_limit=73.5
    ),
    "flatness": flatness(
        PAPER.with_parameters(lag=3e-4),
        largest_acceleration=300.0,
        largest_jerk=1e5,
        torque_limit=73.5,
        **WISHES,
    ),
    "H infinity": h_infinity(PAPER.with_parameters(lag=3e-4), **WISHES, load_torque=10.0, torque_limit=73.5),
    "predictive": predictive(
        ONE_SIDED.with_parameters(lag=3e-4),
        dt=1e-4,
        largest_error=1.0,
        largest_torque=73.5,
        torque_limit=73.5,
    ),
    "notch": notch("torque_wished", "torque_motor", frequency=100.0, dt=1e-4),
    "sliding mode": sliding_mode(PAPER, dt=1e-4, switching_torque=40.0, torque_limit=73.5),
    "speed course": speed_course(largest_acceleration=300.0, largest_jerk=1e5, dt=1e-4),
    "super-twisting": super_twisting(
        PAPER, dt=1e-4, switching_torque=20.0, torque_limit=73.5, integral_rate=200.0
    ),
    "active damping": active_damping(PAPER, dt=1e-4),
    "active damping with limit": active_damping(PAPER, dt=1e-4, torque_limit=73.5),
    "soft landing": soft_landing(PAPER, dt=1e-4, contact_speed=0.6, torque_limit=73.5),
    "soft landing, bounded": soft_landing(
        PAPER, dt=1e-4, contact_speed=0.4, torque_limit=73.5, braking_torque=20.0, motor_bounded=True
    ),
    "torque ramp": torque_ramp(unwinding_rate=4e3, winding_rate=2e4, dt=1e-4),
    "soft landing, estimated backlash": soft_landing(
        PAPER, dt=1e-4, contact_speed=0.6, torque_limit=73.5, tolerance=0.05, backlash_estimated=True
    ),
    "observer + lqi + soft landing": soft_landing_behind_lqi(),
    "minimum": minimum("a", "b", "c", 1e-4),
    "rate limit": rate_limit("a", "b", rate=1e4, dt=1e-4),
    "delay": one_sample_delay("torque_motor", 1e-4, start=0.5),
    "observer 1 + pole placement": observer_1_with_pole_placement(),
}
#: Controllers that keep a torque limit, Nm.
LIMITED = {
    **dict.fromkeys(("pi with limit", "pi with filtered speed", "pi with all"), 20.0),
    **dict.fromkeys(
        (
            "pole placement with limit", "pole placement, by reference", "H infinity", "predictive", "sliding mode",
            "super-twisting", "lqi with limit, lag and friction of the motor", "flatness",
            "active damping with limit", "soft landing", "soft landing, bounded", "soft landing, estimated backlash",
            "observer + lqi + soft landing", "observer 1 + pole placement",
        ),
        73.5,
    ),
}  # fmt: skip
LAWS = {**OBSERVERS, **{f"controller: {name}": law for name, law in CONTROLLERS.items()}}

every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def assert_same_bits(a, b):
    """Equal numbers, and zeros of equal sign."""
    np.testing.assert_array_equal(a, b)
    np.testing.assert_array_equal(np.signbit(a), np.signbit(b))


@every_law
def test_numba_and_plain_python_give_the_same_bits(law):
    inputs = random_inputs(law, 1500, seed=1)
    outputs, faults = numba_run(law, inputs)
    wanted, wanted_faults = python_run(law, inputs)
    assert faults.any()
    np.testing.assert_array_equal(faults, wanted_faults)
    assert_same_bits(outputs, wanted)


@every_law
@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_numba_and_c_give_the_same_bits(law, tmp_path):
    inputs = random_inputs(law, 5000, seed=2)
    outputs, faults = numba_run(law, inputs)
    wanted, wanted_faults = c_run(law, inputs, tmp_path)
    np.testing.assert_array_equal(faults, wanted_faults)
    assert_same_bits(outputs, wanted)


@every_law
def test_sample_by_sample_and_piece_by_piece_it_does_the_same(law):
    inputs = random_inputs(law, 300, seed=3)
    data = dict(zip(law.inputs, inputs.T, strict=True))
    whole = law.run(data)
    wanted = np.column_stack([whole[name] for name in law.outputs])
    state, outputs, faults = law.init(), [], []
    for row in inputs[:200]:
        before = state.copy()
        after, out, fault = law.step(state, row)
        np.testing.assert_array_equal(state, before)
        state = after
        outputs.append(out)
        faults.append(fault != 0)
    assert_same_bits(np.array(outputs), wanted[:200])
    np.testing.assert_array_equal(faults, whole["input_fault"][:200] == 1.0)
    rest = law.run({name: values[200:] for name, values in data.items()}, state=state)
    assert_same_bits(np.column_stack([rest[name] for name in law.outputs]), wanted[200:])
    np.testing.assert_array_equal(rest.final_state["state"], whole.final_state["state"])


CHECKED = {name: law for name, law in LAWS.items() if law.checks}


@pytest.mark.parametrize("law", CHECKED.values(), ids=CHECKED.keys())
def test_checks_that_are_armed_give_the_same_bits(law, tmp_path):
    """Signals that stand and wander slowly, and are missing, jump and freeze for some samples; a short hold time."""
    checks = tuple(replace(check, hold=6, limit=1e-4, forget=0.99) for check in law.checks)
    law, rng, n = replace(law, checks=checks), np.random.default_rng(8), 6000
    checked = [law.inputs.index(check.input) for check in checks]
    inputs = 5.0 * rng.normal(size=(n, len(law.inputs)))
    inputs[:, checked] = 0.002 * np.cumsum(rng.normal(size=(n, len(checked))), axis=0)
    for start in range(50, n, 25):
        i, burst = rng.choice(checked), slice(start, start + rng.integers(1, 12))
        kind, size = rng.integers(4), 10.0 ** rng.uniform(-3.0, 2.0)
        inputs[burst, i] = (np.nan, inputs[start - 1, i], inputs[burst, i] + size, 1e31)[kind]
    outputs, faults = numba_run(law, inputs)
    bits = sum(1 << i for i in checked)
    assert 0.02 < np.mean((faults & bits) != 0) < 0.5
    runs = [python_run(law, inputs)]
    if COMPILER is not None:
        runs.append(c_run(law, inputs, tmp_path))
    for other, other_faults in runs:
        np.testing.assert_array_equal(faults, other_faults)
        assert_same_bits(outputs, other)


def test_corners_of_a_curve_belong_to_the_segment_on_the_right_and_sums_start_with_their_first_product(
    tmp_path,
):
    points = ((-0.7, 0.1), (0.1, 0.3), (0.7, -0.1))
    law = DiscreteSystem(
        inputs=("u",), outputs=("through", "curve"), dt=1.0, curves=(PiecewiseLinear(points, 0.3, -0.7),),
        G=[[1.0]], D=[[1.0], [0.0]], J=[[0.0], [1.0]],
    )  # fmt: skip
    inputs = np.array([[-0.7], [0.1], [0.7], [-0.0], [-5.0], [5.0]])
    wanted, _ = python_run(law, inputs)
    # Measured from the left, the corner at 0.7 would come out as −0.10000000000000003.
    assert wanted[:3, 1].tolist() == [0.1, 0.3, -0.1]
    assert np.signbit(wanted[3, 0])
    assert_same_bits(numba_run(law, inputs)[0], wanted)
    if COMPILER is not None:
        assert_same_bits(c_run(law, inputs, tmp_path)[0], wanted)


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_the_exported_law_gives_the_same_bits_over_100_000_steps(tmp_path):
    law = observer_1_with_pole_placement()
    inputs = random_inputs(law, 100_000, seed=3)
    outputs, faults = numba_run(law, inputs)
    # The law must have used both sides of its torque limit, and the room between.
    assert outputs.min() == -73.5 and outputs.max() == 73.5 and (abs(outputs) < 50.0).any()
    for other, other_faults in (python_run(law, inputs), c_run(law, inputs, tmp_path)):
        np.testing.assert_array_equal(faults, other_faults)
        assert_same_bits(outputs, other)


@every_law
@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_the_largest_accepted_inputs_never_give_nan_in_single_precision(law, tmp_path):
    inputs = 0.999e30 * np.sign(random_inputs(law, 3000, seed=7))
    outputs, _ = c_run(law, inputs, tmp_path, real="float")
    assert not np.any(np.isnan(outputs))


@every_law
def test_json_gives_back_the_very_same_law(law):
    data = law.to_dict()
    again = DiscreteSystem.from_dict(json.loads(json.dumps(data, allow_nan=False)))
    assert again.to_dict() == data
    inputs = random_inputs(law, 200, seed=4)
    assert_same_bits(numba_run(again, inputs)[0], numba_run(law, inputs)[0])


@every_law
@settings(max_examples=30, deadline=None, derandomize=True)
@given(data=st.data())
def test_finite_inputs_never_give_nan(law, data):
    number = st.floats(allow_nan=False, allow_infinity=False)
    sample = st.lists(number, min_size=len(law.inputs), max_size=len(law.inputs))
    inputs = np.array(data.draw(st.lists(sample, min_size=1, max_size=30)))
    tail = np.repeat(inputs[-1:], 200, axis=0)
    outputs, _ = numba_run(law, np.vstack([inputs, tail]))
    assert np.all(np.isfinite(outputs))


@pytest.mark.parametrize(("name", "limit"), LIMITED.items(), ids=LIMITED.keys())
def test_never_a_torque_beyond_the_limit_whatever_comes_in(name, limit):
    law, rng = CONTROLLERS[name], np.random.default_rng(9)
    inputs = rng.normal(size=(3000, len(law.inputs))) * 10.0 ** rng.uniform(-3.0, 31.0, (3000, 1))
    inputs[rng.random(inputs.shape) < 0.05] = np.nan
    torque = numba_run(law, inputs)[0][:, 0]
    assert np.all(np.abs(torque) <= limit)
    assert torque.max() == limit and torque.min() == -limit


@every_law
def test_a_bad_input_that_nobody_checks_is_replaced_flagged_and_forgotten(law):
    law = law.without_checks()
    rng = np.random.default_rng(5)
    clean = np.repeat(rng.normal(size=(4, len(law.inputs))), 50, axis=0)
    broken = clean.copy()
    for i in range(len(law.inputs)):
        broken[60 + i, i] = np.nan
        broken[110 + 2 * i : 112 + 2 * i, i] = [np.inf, -3e30]
    outputs, faults = numba_run(law, broken)
    # Within a constant stretch the last good value is the right one: nothing must differ, then or later.
    assert_same_bits(outputs, numba_run(law, clean)[0])
    wanted = np.zeros(200, dtype=int)
    for i in range(len(law.inputs)):
        wanted[[60 + i, 110 + 2 * i, 111 + 2 * i]] |= 1 << i
    np.testing.assert_array_equal(faults, wanted)


@pytest.mark.parametrize("law", OBSERVERS.values(), ids=OBSERVERS.keys())
def test_observers_recover_from_nan_at_the_start(law):
    rng = np.random.default_rng(6)
    n = int(10.0 / law.dt)
    clean = 0.1 * rng.normal(size=(n, len(law.inputs)))
    if "torque_motor" in law.inputs:
        # Both sides of the joint touch: a motor that floats in the gap is not seen from the load, and wanders.
        clean[:, 0] += 6.0 * np.sign(np.sin(2.0 * np.pi * 5.0 * law.dt * np.arange(n)))
    broken = clean.copy()
    broken[:5] = np.nan
    outputs, _ = numba_run(law, broken)
    wanted, _ = numba_run(law, clean)
    early, late = (np.max(np.abs((outputs - wanted)[part])) for part in (slice(0, 100), slice(-100, None)))
    assert early > 0.0
    assert late < 1e-3 * early


@pytest.mark.parametrize("law", OBSERVERS.values(), ids=OBSERVERS.keys())
def test_observers_are_stable_in_contact_and_sliding(law):
    # Far out on the right, each curve has its last slope: the gap is closed, the friction at its level. The positive
    # parts in a gate are zero there: it is open, and the innovation far from its limit.
    slopes = np.diag([0.0 if curve == POSITIVE_PART else curve.slope_right for curve in law.curves])
    through = np.linalg.solve(np.eye(len(slopes)) - slopes @ law.H, slopes @ law.F)
    assert np.max(np.abs(np.linalg.eigvals(law.A + law.E @ through))) < 1.0

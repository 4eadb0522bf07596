"""The Kalman observer: the paper's gains, the rules of its discretisation, friction, sensors, misuse."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from table_i import PAPER

from lostmotion.drivetrain import Friction
from lostmotion.errors import InvalidInput
from lostmotion.observers import h_infinity, kalman, kalman_gain, neural_network
from lostmotion.signals import excitation
from lostmotion.simulation import simulate
from lostmotion.systems import connect


def rms(error):
    return float(np.sqrt(np.mean(np.square(error))))


def reversals(dt, seed=1, seconds=3.0):
    """Motor torque: a ±6 Nm square wave of 5 Hz and noise of 10 Nm, held over dt."""
    n = round(seconds / dt)
    wave = 6.0 * np.sign(np.sin(2.0 * np.pi * 5.0 * dt * np.arange(n)))
    return wave + 10.0 * np.random.default_rng(seed).normal(size=n)


def without_mid_sample(observer, plant):
    """The same observer with the gap curve of the state evaluated at the start of the sample."""
    lead = plant.damping / plant.stiffness if plant.contact == "viscoelastic" else 0.0
    f = observer.F.copy()
    f[0, 1:3] = [lead, -lead]
    return replace(observer, F=f)


# Gains in continuous time (Fietzek & Rinderknecht, eq. 5–8; numbers recomputed, the paper prints none).


def test_gain_of_observer_1():
    gain = kalman_gain(PAPER.with_parameters(viscous=0.0))
    np.testing.assert_allclose(gain[:, 0], [-0.39988, 503.061, -50.4388], rtol=1.2e-5)


def test_gain_of_observer_2():
    gain = kalman_gain(PAPER.with_parameters(viscous=0.0), ("torque_shaft", "speed_motor"))
    wanted = [[0.30749, -0.031170], [-14.8505, 122.939], [-4.40545, 3.48512]]
    np.testing.assert_allclose(gain, wanted, rtol=1.5e-5)


def test_poles_approach_those_of_the_continuous_observers():
    plant = PAPER.with_parameters(viscous=0.0, coulomb=0.0, backlash=0.0)
    for measured, wanted in (
        (("speed_motor",), [-253.79 - 682.50j, -253.79 + 682.50j, -20.87]),
        (("torque_shaft", "speed_motor"), [-1747.3, -308.87, -20.84]),
    ):
        # Without backlash and friction no curve is left, and A alone tells the poles (after the model's three states
        # comes the mean of the torque, for samples without one).
        dt = 1e-6
        model = kalman(plant, measured=measured, dt=dt).A[:3, :3]
        poles = np.log(np.linalg.eigvals(model).astype(complex)) / dt
        np.testing.assert_allclose(np.sort_complex(poles), np.sort_complex(np.array(wanted)), rtol=3e-3)


# Discretisation.


@pytest.mark.parametrize("contact", ["viscoelastic", "dead_zone"])
@pytest.mark.parametrize("dt, good, better_by", [(1e-4, 0.01e-3, 20.0), (1e-3, 0.4e-3, 5.0)])
def test_the_mid_sample_rule(contact, dt, good, better_by):
    plant = PAPER.with_contact(contact)
    recording = simulate(plant, dt=dt, torque_motor=reversals(dt))
    observer = kalman(plant, dt=dt)
    error = rms(observer.run(recording)["twist_estimated"] - recording["twist"])
    plain = rms(without_mid_sample(observer, plant).run(recording)["twist_estimated"] - recording["twist"])
    assert error < good
    assert plain > better_by * error


def test_load_speed_and_shaft_torque_on_its_own_model():
    recording = simulate(PAPER, dt=1e-4, torque_motor=reversals(1e-4))
    found = kalman(PAPER, dt=1e-4).run(recording)
    assert rms(found["speed_load_estimated"] - recording["speed_load"]) < 1e-3 * np.ptp(
        recording["speed_load"]
    )
    assert rms(found["torque_shaft_estimated"] - recording["torque_shaft"]) < 1e-3 * np.ptp(
        recording["torque_shaft"]
    )
    # The motor speed taken as an estimate of the load speed is far worse.
    assert rms(recording["speed_motor"] - recording["speed_load"]) > 0.1 * np.ptp(recording["speed_load"])


def test_inside_the_gap_it_shows_no_shaft_torque_and_no_elastic_twist():
    plant = PAPER.with_parameters(viscous=0.0, coulomb=0.0)
    observer = kalman(plant, dt=1e-4)
    start = np.zeros(len(observer.states))
    start[:3] = [-0.004, 0.5, 0.0]
    n = 100  # 10 ms at 0.5 rad/s: 5 mrad, from −4 to 1 mrad
    found = observer.run({"torque_motor": np.zeros(n), "speed_motor": np.full(n, 0.5)}, state=start)
    # The gap held over each sample costs (ωT)²/12 of the motion, ω = 634 rad/s: 0.03 % of 5 mrad.
    np.testing.assert_allclose(found["twist_estimated"], -0.004 + 0.5e-4 * np.arange(n), rtol=0.0, atol=2e-6)
    assert not found["torque_shaft_estimated"].any()
    assert not found["twist_elastic_estimated"].any()


def test_without_curves_it_steps_by_the_matrix_exponential():
    plant = PAPER.with_parameters(backlash=0.0, coulomb=0.0)
    observer = kalman(plant, dt=1e-3)
    assert not observer.curves
    a, b = plant.linear()
    # Fed with its own estimate the innovation is zero, and the model is left.
    alone = connect(
        [observer.renamed({"speed_motor": "speed_motor_estimated"})],
        inputs=("torque_motor",), outputs=observer.outputs,
    )  # fmt: skip
    # A fourth state, the mean of the torque for samples without one, moves none of the model's.
    np.testing.assert_allclose(alone.A[:3], np.pad(expm(a * 1e-3), ((0, 0), (0, 1))), rtol=1e-10, atol=1e-12)
    settled = np.linalg.solve(a, (expm(a * 1e-3) - np.eye(3)) @ b)
    np.testing.assert_allclose(alone.B[:3], settled, rtol=1e-9, atol=1e-12)


def test_backlash_that_counts_as_none_is_linear():
    small, none = (kalman(PAPER.with_parameters(backlash=b), dt=1e-4) for b in (1e-11, 0.0))
    assert small.to_dict() == none.to_dict()


# Friction.


def test_a_stuck_load_rests_in_the_model_to_rounding():
    observer = kalman(PAPER, dt=1e-4)
    alone = connect(
        [observer.renamed({"speed_motor": "speed_motor_estimated"})],
        inputs=("torque_motor",), outputs=("speed_load_estimated", "friction_load_estimated"),
    )  # fmt: skip
    start = np.zeros(len(alone.states))
    start[0] = 0.006 + 1.0 / 6285.896
    # 1 Nm through a wound-up shaft, half of what starts the load.
    found = alone.run({"torque_motor": np.full(5000, 1.0)}, state=start)
    assert np.max(np.abs(found["speed_load_estimated"])) < 1e-15
    np.testing.assert_allclose(found["friction_load_estimated"][1:], 1.0, atol=1e-6)


def test_under_stiction_the_load_speed_is_right_and_does_not_chatter():
    dt = 1e-4
    noise = 3.0 * np.random.default_rng(2).normal(size=30_000)
    torque = noise + np.sign(np.sin(2.0 * np.pi * 5.0 * dt * np.arange(noise.size)))
    recording = simulate(PAPER, dt=dt, torque_motor=torque)
    stuck = recording["speed_load"] == 0.0
    assert 0.2 < np.mean(stuck) < 0.8
    found = kalman(PAPER, dt=dt).run(recording)
    # The sign of an estimated speed would put ±2 Nm on the load: 1.8e-3 rad/s in each sample.
    assert rms(found["speed_load_estimated"][stuck]) < 1e-5
    assert np.max(np.abs(np.diff(found["friction_load_estimated"]))[stuck[1:]]) < 2.0


def test_asymmetric_friction_reaches_both_levels():
    levels = (2.5, 1.0)
    plant = replace(PAPER, frictions=(Friction(), Friction(levels, 0.0)))
    observer = kalman(plant, dt=1e-4)
    for torque, wanted in ((12.0, levels[0]), (-12.0, -levels[1])):
        recording = simulate(plant, dt=1e-4, torque_motor=np.full(3000, torque))
        found = observer.run(recording)
        assert found["friction_load_estimated"][-1] == pytest.approx(wanted, abs=1e-12)
        assert found["speed_load_estimated"][-1] == pytest.approx(recording["speed_load"][-1], abs=1e-4)


def test_friction_of_the_motor():
    plant = PAPER.with_parameters(coulomb_motor=0.5, viscous_motor=0.002)
    recording = simulate(plant, dt=1e-4, torque_motor=reversals(1e-4))
    right, wrong = (
        rms(kalman(p, dt=1e-4).run(recording)["twist_estimated"] - recording["twist"])
        for p in (plant, PAPER)
    )  # fmt: skip
    assert right < 0.02e-3
    assert wrong > 5.0 * right


# Sensors and actuator.


@pytest.mark.parametrize(
    "measured",
    [
        ("torque_shaft", "speed_motor"),
        ("angle_motor",),
        ("twist", "speed_load"),
        ("angle_motor", "torque_shaft"),
    ],
)
def test_other_sensors_find_a_wrong_start(measured):
    recording = simulate(PAPER, dt=1e-4, torque_motor=reversals(1e-4))
    observer = kalman(PAPER, measured=measured, dt=1e-4)
    start = np.zeros(len(observer.states))
    start[:3] = [0.005, 3.0, -2.0]
    found = observer.run(recording, state=start).window(1.5)
    truth = recording.window(1.5)
    for signal in ("twist", "speed_motor", "speed_load", "torque_shaft"):
        assert rms(found[f"{signal}_estimated"] - truth[signal]) < 5e-3 * np.ptp(truth[signal])
    assert ("angle_motor_estimated" in found) == ("angle_motor" in measured)
    if "angle_motor" in measured:
        assert rms(found["angle_motor_estimated"] - truth["angle_motor"]) < 1e-4


@pytest.mark.parametrize("dt", [5e-4, 1e-3, 2e-3])
@pytest.mark.parametrize("contact", ["physical", "dead_zone"])
@pytest.mark.parametrize("more", ["twist", "torque_shaft", "speed_load"])
def test_a_further_sensor_never_spoils_a_long_sample(dt, contact, more):
    """A twist trusted to 1 mrad put the gap's term, held over the sample, into the speeds: eight to eleven times."""
    torque = excitation(4.0, dt, seed=2, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    plant = PAPER.with_parameters(contact=contact)
    recording = simulate(plant, dt=dt, torque_motor=torque)
    errors = []
    for measured in (("speed_motor",), (more, "speed_motor")):
        found = kalman(PAPER, measured=measured, dt=dt).run(recording).window(0.5)
        errors.append(rms(found["speed_load_estimated"] - recording.window(0.5)["speed_load"]))
    assert errors[1] < 2.0 * errors[0]


def test_outputs_and_inputs_by_name():
    observer = kalman(PAPER, measured=("torque_shaft", "speed_motor"), dt=1e-4)
    assert observer.inputs == ("torque_motor", "torque_shaft", "speed_motor")
    assert observer.outputs == (
        "twist_estimated", "twist_elastic_estimated", "speed_motor_estimated", "speed_load_estimated",
        "torque_shaft_estimated", "friction_load_estimated",
    )  # fmt: skip


def test_actuator_lag_is_a_state():
    plant = PAPER.with_parameters(lag=5e-4)
    torque = reversals(1e-4)
    recording = simulate(plant, dt=1e-4, torque_motor=torque)
    observer = kalman(plant, dt=1e-4)
    assert "torque_actuator" in observer.states
    data = {"torque_motor": torque, "speed_motor": recording["speed_motor"]}
    right, wrong = (
        rms(o.run(data)["twist_estimated"] - recording["twist"]) for o in (observer, kalman(PAPER, dt=1e-4))
    )
    assert right < 0.02e-3
    assert wrong > 5.0 * right


@pytest.mark.parametrize("dt", [1e-4, 1e-3])
def test_count_averaged_speed(dt):
    recording = simulate(PAPER, dt=dt, torque_motor=reversals(dt))
    averaged = np.diff(recording["angle_motor"], prepend=0.0) / dt
    data = {"torque_motor": recording["torque_motor"], "speed_motor": averaged}
    right, wrong = (
        rms(
            kalman(PAPER, dt=dt, speed_from_counts=c).run(data)["speed_load_estimated"]
            - recording["speed_load"]
        )
        for c in (True, False)
    )
    assert right < 0.5 * wrong


# Misuse.


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"measured": ()}, "measured"),
        ({"measured": ("speed",)}, "measured"),
        ({"measured": ("speed_motor", "speed_motor")}, "each once"),
        ({"process_covariance": {"speed": 1.0}}, "process_covariance"),
        ({"measurement_covariance": {"speed_motor": 0.0}}, "positive numbers"),
        ({"process_covariance": {"twist": float("nan")}}, "process_covariance"),
        ({"measured": ("twist",), "speed_from_counts": True}, "speed_from_counts"),
        ({"dt": 0.0}, "dt"),
        ({"dt": -1e-3}, "dt"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        kalman(PAPER, **{"dt": 1e-4, **arguments})


@pytest.mark.parametrize("measured", [("twist",), ("torque_shaft",), ("torque_shaft", "twist")])
def test_sensors_that_cannot_see_the_rotation(measured):
    plant = PAPER.with_parameters(viscous=0.0)
    with pytest.raises(InvalidInput, match="detectable"):
        kalman(plant, measured=measured, dt=1e-4)
    with pytest.raises(InvalidInput, match="detectable"):
        kalman_gain(plant, measured)


@pytest.mark.parametrize("lag", [1e-12, 1e-9, 1e-8, 1e-7])
def test_a_lag_far_below_the_sample_time_is_none(lag: float) -> None:
    """Van Loan's formula alone overflows there."""
    rng = np.random.default_rng(1)
    data = {"torque_motor": rng.normal(0.0, 10.0, 500), "speed_motor": rng.normal(0.0, 1.0, 500)}
    plain = kalman(PAPER, dt=1e-4).run(data)
    lagging = kalman(PAPER.with_parameters(lag=lag), dt=1e-4).run(data)
    for name in ("speed_load_estimated", "twist_estimated"):
        assert np.max(np.abs(lagging[name] - plain[name])) < 0.01 * np.ptp(plain[name]), name


@pytest.mark.parametrize("make", [kalman, h_infinity, neural_network])
def test_a_sample_too_long_for_the_shaft_is_refused(make):
    """Beyond, the gap term that is held over a sample swings up; without a gap nothing is held."""
    stiff = PAPER.with_parameters(stiffness=(1.6 / 1e-3) ** 2 / (1.0 / 0.0182 + 1.0 / 0.111))
    with pytest.raises(InvalidInput, match=r"turns by 1\.6 rad.*extended_kalman"):
        make(stiff, dt=1e-3)
    make(stiff.with_parameters(backlash=0.0), dt=1e-3)
    make(stiff, dt=9e-4)

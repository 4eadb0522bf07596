"""PI speed controller: arithmetic, limit, anti-windup, and the paper's step."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion.controllers import pi
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.simulation import Sensor, simulate
from lostmotion.systems import DiscreteSystem, connect


def test_it_is_proportional_plus_integral():
    torque = pi(dt=1e-3, kp=10.0, ki=200.0).run({"speed_reference": [1.0] * 4, "speed_motor": [0.5] * 4})
    np.testing.assert_allclose(torque["torque_motor"], 5.0 + 0.1 * np.arange(4), rtol=1e-14)


def test_within_the_limit_the_limit_changes_nothing():
    rng = np.random.default_rng(1)
    data = {"speed_reference": rng.normal(size=500), "speed_motor": rng.normal(size=500)}
    free = pi(dt=1e-3).run(data)["torque_motor"]
    limited = pi(dt=1e-3, torque_limit=1e4).run(data)["torque_motor"]
    np.testing.assert_allclose(limited, free, rtol=1e-9, atol=1e-9)


def test_it_does_not_wind_up():
    limit, dt = 20.0, 1e-3
    # Ten seconds of an error that is out of reach, then the same error the other way.
    error = np.concatenate([np.full(10_000, 5.0), np.full(10, -5.0)])
    law = pi(dt=dt, torque_limit=limit)
    torque = law.run({"speed_reference": error, "speed_motor": np.zeros_like(error)})["torque_motor"]
    assert np.all(torque[:10_000] == limit)
    assert torque[10_000] == -limit
    # Without anti-windup the integral would have reached 10 000 Nm.
    state = law.run({"speed_reference": error, "speed_motor": 0 * error}).final_state["state"]
    assert abs(state[0]) <= limit


def rigid_drive(inertia, torque_load, dt):
    """speed⁺ = speed + dt/J·(torque_motor − torque_load), the load torque as a constant input."""
    return DiscreteSystem(
        inputs=("torque_motor", "torque_load"), outputs=("speed_motor",), states=("speed",), dt=dt,
        A=[[1.0]], B=[[dt / inertia, -dt / inertia]], C=[[1.0]], name="rigid",
    )  # fmt: skip


def test_with_the_realised_torque_it_does_not_wind_up_whoever_limits():
    """By hand, with a drive that gives at most 3 Nm, one sample later; the law's own limit and friction are further."""
    plant = Drivetrain.two_mass(
        inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, coulomb=1.0, viscous=0.1, coulomb_motor=0.5
    )
    kp, ki, dt = 2.0, 50.0, 1e-3
    for limit in (4.0, math.inf):
        law = pi(dt=dt, kp=kp, ki=ki, torque_limit=limit, friction_of=plant, realised_torque=True)
        state, integral, acting, last = law.init(), 0.0, 0.0, 0.0
        for k in range(300):
            reference, speed = (5.0, 0.0) if k < 200 else (0.2, 0.0)
            wished = integral + kp * (reference - speed) + 1.5 + 0.1 * reference
            state, (torque,), _ = law.step(state, [reference, speed, acting])
            assert torque == pytest.approx(np.clip(wished, -limit, limit), abs=1e-9)
            integral += dt * ki * (reference - speed) + dt * ki / kp * (acting - last)
            acting, last = np.clip(torque, -3.0, 3.0), wished
        # Wound up it would be 5·50·0.2 = 50 Nm.
        assert abs(integral) < 15.0


def test_a_drive_that_gives_less_than_asked_overshoots_less_with_the_realised_torque():
    plant = Drivetrain.two_mass(
        inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.4, torque_limit=2.0
    )
    reference, overshoot = np.full(8000, 5.0), {}
    for realised in (True, False):
        law = pi(dt=1e-4, kp=4.0, ki=40.0, torque_limit=20.0, realised_torque=realised)
        sensors = {"torque_motor_acting": Sensor("torque_motor")} if realised else {}
        run = simulate(plant, dt=1e-4, law=law, delay=1, sensors=sensors, speed_reference=reference)
        overshoot[realised] = np.max(run["speed_load"]) / 5.0 - 1.0
    assert overshoot[True] < 0.25 * overshoot[False]


def test_no_steady_error_under_load():
    dt = 1e-3
    law = connect(
        [pi(dt=dt, torque_limit=30.0), rigid_drive(0.13, 3.0, dt)],
        inputs=("speed_reference", "torque_load"), outputs=("speed_motor", "torque_motor"),
    )  # fmt: skip
    found = law.run({"speed_reference": np.full(5000, 2.0), "torque_load": np.full(5000, 3.0)})
    assert found["speed_motor"][-1] == pytest.approx(2.0, abs=1e-9)
    assert found["torque_motor"][-1] == pytest.approx(3.0, abs=1e-9)


ROUGH = Drivetrain.two_mass(
    inertia_motor=0.02, inertia_load=0.11, stiffness=6e3, coulomb=2.0, coulomb_motor=0.5, viscous=0.3,
    viscous_motor=0.1,
)  # fmt: skip


@pytest.mark.parametrize(("limit", "slow"), [(math.inf, 0.0), (6.0, 0.0), (6.0, 0.005)])
def test_filters_and_friction_feedforward_by_hand(limit, slow):
    dt, kp, ki, time = 1e-3, 3.0, 40.0, 0.02
    law = pi(
        dt=dt, kp=kp, ki=ki, torque_limit=limit, filter_time=time, speed_filter_time=slow, friction_of=ROUGH
    )
    rng = np.random.default_rng(6)
    given, speed = np.repeat(2.0 * rng.normal(size=20), 20), rng.normal(size=400)
    found = law.run({"speed_reference": given, "speed_motor": speed})["torque_motor"]
    integral = filtered = measured = 0.0
    wanted = np.empty(400)
    for k in range(400):
        measured += (1.0 - math.exp(-dt / slow) if slow else 1.0) * (speed[k] - measured)
        error = filtered - measured
        full = 2.5 + 0.4 * max(abs(filtered), 0.1)
        friction = math.copysign(full * min(abs(filtered) / 0.1, 1.0), filtered)
        asked = integral + kp * error + friction
        wanted[k] = min(max(asked, -limit), limit)
        integral += dt * ki * error + dt * ki / kp * (wanted[k] - asked)
        filtered += (1.0 - math.exp(-dt / time)) * (given[k] - filtered)
    np.testing.assert_allclose(found, wanted, rtol=1e-11, atol=1e-11)
    assert limit == math.inf or 0.05 < np.mean(np.abs(found) == limit) < 0.9


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"filter_time": -1.0}, r"pi\.filter_time"),
        ({"speed_filter_time": math.inf}, r"pi\.speed_filter_time"),
        ({"kp": 0.0}, r"pi\.kp"),
        ({"kp": math.nan}, r"pi\.kp"),
        ({"dt": -1.0}, r"pi\.dt"),
        ({"torque_limit": 0.0}, r"pi\.torque_limit"),
        ({"ki": 10_000.0}, r"pi\.ki"),
        ({"ki": -1.0}, r"pi\.ki"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        pi(**{"dt": 1e-3, **arguments})

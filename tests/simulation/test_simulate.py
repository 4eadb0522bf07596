"""simulate: what it returns, and what it refuses."""

from __future__ import annotations

import math

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import Drivetrain, Friction, Shaft

DT = 1e-4


def test_rows_are_states_before_the_torque_acts():
    rigid = Drivetrain((0.5,))
    recording = lm.simulate(rigid, torque_motor=[1.0, 2.0, 0.0], dt=0.1)
    np.testing.assert_allclose(recording["speed_motor"], [0.0, 0.2, 0.6], rtol=1e-14)
    np.testing.assert_allclose(recording["angle_motor"], [0.0, 0.01, 0.05], rtol=1e-14)
    assert recording.final_state["state"][0] == pytest.approx(0.6)
    assert set(recording.origin.values()) == {"simulated"}


def test_signals_of_two_masses_fit_each_other(paper):
    recording = lm.simulate(paper, torque_motor=10.0 * np.random.default_rng(0).standard_normal(500), dt=DT)
    np.testing.assert_allclose(
        recording["angle_motor"] - recording["angle_load"], recording["twist"], atol=1e-15
    )


def test_load_torque_acts_on_the_load(paper):
    rigid_total = paper.inertia_total
    plant = Drivetrain.two_mass(**{**TABLE_I, "coulomb": 0.0, "viscous": 0.0, "backlash": 0.0})
    recording = lm.simulate(plant, torque_motor=np.zeros(1000), torque_load=np.full(1000, 2.0), dt=DT)
    momentum = plant.inertia_motor * recording["speed_motor"] + plant.inertia_load * recording["speed_load"]
    np.testing.assert_allclose(momentum, 2.0 * recording.time, atol=1e-12)
    assert recording["torque_shaft"].mean() == pytest.approx(
        -2.0 * plant.inertia_motor / rigid_total, rel=0.1
    )


def test_events_come_in_order_and_alternate(paper):
    recording = lm.simulate(paper, torque_motor=10.0 * np.random.default_rng(1).standard_normal(5000), dt=DT)
    times = [e.time for e in recording.events]
    assert len(times) > 50
    assert times == sorted(times)
    contact = [e.kind for e in recording.events if e.place == "shaft 1"]
    assert set(contact[::2]) == {"impact"} and set(contact[1::2]) == {"separation"}
    stick = [e for e in recording.events if e.kind == "stick"]
    assert all(abs(e.speed) < 1e-12 for e in stick)


@pytest.mark.parametrize(("torque", "kinds"), [(-5.0, []), (-0.5, ["stick"])])
def test_a_speed_that_passes_through_rest_does_not_stick(torque, kinds):
    """Above the breakaway level rest is entered and left at one time, which is no event of the drivetrain."""
    plant = Drivetrain((0.5,), frictions=(Friction(1.0),))
    recording = lm.simulate(plant, torque_motor=np.full(2000, torque), dt=1e-3, state=(1.0,))
    assert [event.kind for event in recording.events] == kinds
    expected = 1.0 + (torque - 1.0) / 0.5 * recording.time
    after = expected < 0.0
    expected[after] = (torque + 1.0) / (torque - 1.0) * expected[after] if torque < -1.0 else 0.0
    np.testing.assert_allclose(recording["speed_motor"], expected, rtol=0, atol=1e-12)


def test_stribeck_friction_brakes_as_its_curve_says():
    friction = Friction(0.5, 0.01, stribeck=((0.0, 0.4), (1.0, 0.1), (3.0, 0.0)))
    plant = Drivetrain((0.1,), frictions=(friction,))
    recording = lm.simulate(plant, torque_motor=np.zeros(2000), dt=1e-3, state=(4.0,))
    speed = recording["speed_motor"]
    moving = slice(0, np.flatnonzero(speed == 0.0)[0] - 1)
    middle = 0.5 * (speed[1:] + speed[:-1])
    braking = -0.1 * np.diff(speed) / 1e-3
    expected = np.array([friction.torque(float(w)) for w in middle])
    assert np.max(np.abs(braking - expected)[moving]) < 2e-4
    assert not speed[-500:].any()


def test_torque_limit_and_lag():
    plant = Drivetrain((1.0,), actuator=lm.Actuator(lag=0.01, torque_limit=2.0))
    recording = lm.simulate(plant, torque_motor=np.full(1000, 5.0), dt=1e-3)
    t = recording.time
    np.testing.assert_array_equal(recording["torque_motor"], 2.0)
    np.testing.assert_allclose(
        recording["speed_motor"], 2.0 * (t - 0.01 * (1.0 - np.exp(-t / 0.01))), atol=1e-13
    )


def bad_calls() -> dict[str, tuple[dict, str]]:
    good = np.zeros(10)
    return {
        "nan": ({"torque_motor": np.where(np.arange(10) == 3, np.nan, 0.0)}, "sample 3"),
        "infinity": ({"torque_motor": np.full(10, np.inf)}, "inf"),
        "shape": ({"torque_motor": np.zeros((5, 2))}, "shape"),
        "length": ({"torque_motor": good, "torque_load": np.zeros(9)}, "length"),
        "short": ({"torque_motor": [1.0]}, "two or more"),
        "dt": ({"torque_motor": good, "dt": 0.0}, "simulate.dt"),
        "dt nan": ({"torque_motor": good, "dt": math.nan}, "simulate.dt"),
        "nothing": ({}, "Give the torque"),
        "unknown": ({"torque_motor": good, "speed_reference": good}, "speed_reference"),
        "state length": ({"torque_motor": good, "state": (0.0, 0.0)}, "simulate.state"),
        "state nan": ({"torque_motor": good, "state": (0.0, math.nan, 0.0)}, "simulate.state"),
        "state of another": (
            {"torque_motor": good, "state": {"state": (0.0,), "digits": ()}},
            "simulate.state",
        ),
    }


@pytest.mark.parametrize("name", bad_calls())
def test_wrong_input_is_refused(name, paper):
    arguments, where = bad_calls()[name]
    with pytest.raises(lm.InvalidInput, match=where):
        lm.simulate(paper, **{"dt": DT, **arguments})


def test_too_many_modes_are_refused():
    n = 14
    plant = Drivetrain((0.1,) * n, (Shaft(1e3, 0.1, 0.01),) * (n - 1))
    with pytest.raises(lm.InvalidInput, match="combinations"):
        lm.simulate(plant, torque_motor=np.zeros(5), dt=DT)


def test_event_space_grows():
    """More events than the space that is set aside at first."""
    plant = Drivetrain.two_mass(inertia_motor=0.01, inertia_load=0.01, stiffness=1e4, backlash=0.001)
    recording = lm.simulate(plant, torque_motor=np.zeros(40_000), dt=DT, state=(0.0, 1.0, -1.0))
    assert len(recording.events) > 2048
    impacts = [e for e in recording.events if e.kind == "impact"]
    np.testing.assert_allclose([abs(e.speed) for e in impacts], 2.0, rtol=1e-11)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"sensors": {"speed_motor": lm.Sensor("speed_motor")}}, "no law"),
        ({"seed": -1}, "from 0 on"),
        ({"dt": 1e-300}, "sample time"),
    ],
)
def test_what_would_do_nothing_is_refused(paper, arguments, said):
    with pytest.raises(lm.InvalidInput, match=said):
        lm.simulate(paper, **{"dt": 1e-4, "torque_motor": np.ones(5), **arguments})


def test_a_torque_that_never_acts_is_refused(paper):
    law = lm.controllers.pi(dt=1e-4)
    with pytest.raises(lm.InvalidInput, match="fewer than the 5"):
        lm.simulate(paper, law=law, speed_reference=np.ones(5), dt=1e-4, delay=5)

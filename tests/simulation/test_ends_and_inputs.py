"""Ends that are held or moved, and torques into any inertia."""

from __future__ import annotations

import math

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Drivetrain, Friction, Shaft

DT = 1e-4
SHAFT = Shaft(5000.0, 0.3, 0.01)


def test_held_load_leaves_an_oscillator():
    plant = Drivetrain((0.02, 0.1), (Shaft(5000.0),), locked="load")
    recording = lm.simulate(plant, torque_motor=np.zeros(2000), dt=DT, state=(1e-3, 0.0, 0.0))
    wave = 1e-3 * np.cos(math.sqrt(5000.0 / 0.02) * recording.time)
    np.testing.assert_allclose(recording["twist"], wave, rtol=0.0, atol=1e-14)
    assert not recording["speed_load"].any()


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_free_angle_shows_against_a_held_load(contact):
    """The backlash test: a slowly oscillating torque turns the motor by the free angle and a little twist."""
    shaft = Shaft(5000.0, 0.3, 0.01, contact)
    plant = Drivetrain((0.02, 0.1), (shaft,), (Friction(viscous=1.0), Friction(2.0)), locked="load")
    torque = 0.5 * np.sin(2.0 * np.pi * 2.0 * np.arange(10_000) * DT)
    recording = lm.simulate(plant, torque_motor=torque, dt=DT)
    high, low = (np.median(recording["angle_motor"][torque * sign > 0.49]) for sign in (1, -1))
    assert high - low == pytest.approx(0.01 + 2 * 0.495 / 5000.0, rel=0.01)
    assert {e.place for e in recording.events} == {"shaft 1"}


def test_moved_load_follows_its_speed():
    plant = Drivetrain((0.02, 0.1), (SHAFT,), locked="load")
    speed = 2.0 * np.sin(np.arange(500) * 0.05)
    recording = lm.simulate(plant, torque_motor=np.zeros(500), speed_load=speed, dt=DT)
    np.testing.assert_allclose(recording["speed_load"], speed, rtol=0.0, atol=1e-12)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * DT)])
    np.testing.assert_allclose(
        recording["angle_load"] - recording["angle_load"][0], angle, rtol=0.0, atol=1e-13
    )
    assert recording["speed_motor"].any()


def swing(n: int = 500) -> tuple[np.ndarray, np.ndarray]:
    """Angle (rad) and speed (rad/s) of a sine of 8 Hz about 0.3 rad."""
    omega, t = 50.0, np.arange(n) * DT
    return 0.3 + 0.04 * np.sin(omega * t), 0.04 * omega * np.cos(omega * t)


@pytest.mark.parametrize("end", ["load", "motor"])
@pytest.mark.parametrize("both", [False, True])
def test_moved_end_follows_its_angle(end, both):
    """The angle holds at every sample; between, it is linear, or has the given speed's change."""
    plant = Drivetrain((0.02, 0.05, 0.1), (SHAFT, Shaft(8000.0, 0.2)), locked=end)
    angle, speed = swing()
    given = {f"angle_{end}": angle} | ({f"speed_{end}": speed} if both else {})
    start = (0.001, -0.002, 1.0, 1.0, 1.0)
    recording = lm.simulate(plant, torque_2=np.full(500, 0.5), dt=DT, state=start, energy=True, **given)
    np.testing.assert_allclose(recording[f"angle_{end}"], angle, rtol=0.0, atol=1e-13)
    slope = np.diff(angle) / DT
    expected = speed[:-1] if both else slope
    np.testing.assert_allclose(
        recording[f"speed_{end}"][:-1], expected, rtol=0.0, atol=1e-4 if both else 1e-9
    )
    assert np.ptp(recording["speed_2"]) > 1.0
    power = np.abs(recording["torque_shaft"] * recording[f"speed_{end}"]).sum() * DT
    assert np.max(np.abs(recording.energy()["balance"])) <= 1e-9 * power


def test_an_angle_is_the_limit_of_ever_finer_speeds():
    """Linear angle: the same as the piecewise constant speed, given as steps on a hundred times finer samples."""
    plant = Drivetrain((0.02, 0.1), (SHAFT,), locked="load")
    angle, _ = swing(40)
    coarse = lm.simulate(plant, torque_motor=np.zeros(40), angle_load=angle, dt=DT)
    slope = np.append(np.diff(angle), np.diff(angle)[-1]) / DT
    fine = lm.simulate(
        plant,
        torque_motor=np.zeros(40 * 100),
        speed_load=np.repeat(slope, 100),
        dt=DT / 100,
        state=(0.0, 0.0, 0.0),
    )
    # Each step of the fine speed takes a hundredth of a sample.
    np.testing.assert_allclose(coarse["speed_motor"], fine["speed_motor"][::100], rtol=0.0, atol=2e-3)
    assert np.max(np.abs(coarse["speed_motor"])) > 0.4


def test_angle_and_speed_of_different_motions_are_refused():
    plant = Drivetrain((0.02, 0.1), (SHAFT,), locked="load")
    angle, speed = swing()
    for wrong in (2.0 * speed, -speed, np.roll(speed, 30), np.zeros(500)):
        with pytest.raises(lm.InvalidInput, match="angle_load and speed_load"):
            lm.simulate(plant, torque_motor=np.zeros(500), dt=DT, angle_load=angle, speed_load=wrong)
    with pytest.raises(lm.InvalidInput, match="lengths"):
        lm.simulate(plant, torque_motor=np.zeros(500), dt=DT, angle_load=angle, speed_load=speed[:-1])
    with pytest.raises(lm.InvalidInput, match="angle_load"):
        lm.simulate(
            plant, torque_motor=np.zeros(500), dt=DT, angle_load=np.where(angle > 0.33, np.nan, angle)
        )
    with pytest.raises(lm.InvalidInput, match="angle_load"):
        lm.simulate(Drivetrain((0.02, 0.1), (SHAFT,)), torque_motor=np.zeros(500), dt=DT, angle_load=angle)


@pytest.mark.parametrize("kind", ["speed", "angle", "both"])
def test_going_on_with_a_moved_end_equals_going_through(kind):
    plant = Drivetrain((0.02, 0.1), (SHAFT,), locked="load")
    angle, speed = swing()
    given = {"angle_load": angle, "speed_load": speed}
    given = given if kind == "both" else {f"{kind}_load": given[f"{kind}_load"]}
    push = np.full(500, 1.0)
    whole = lm.simulate(plant, torque_motor=push, dt=DT, **given)
    # One sample twice: what is given of a sample ends at the next one's start.
    first = lm.simulate(plant, torque_motor=push[:201], dt=DT, **{n: v[:201] for n, v in given.items()})
    short = lm.simulate(plant, torque_motor=push[:200], dt=DT, **{n: v[:200] for n, v in given.items()})
    np.testing.assert_array_equal(first["speed_motor"][:200], whole["speed_motor"][:200])
    second = lm.simulate(
        plant,
        torque_motor=push[200:],
        dt=DT,
        state=short.final_state,
        **{n: v[200:] for n, v in given.items()},
    )
    # Without the next sample the last one runs at a constant speed: 2e-3 rad/s within one sample.
    np.testing.assert_allclose(second["speed_motor"], whole["speed_motor"][200:], rtol=0.0, atol=1e-3)
    expected = angle if kind != "speed" else whole["angle_load"]
    np.testing.assert_allclose(second["angle_load"], expected[200:], rtol=0.0, atol=1e-6)


def test_a_moved_end_in_a_loop():
    """Speed control of the motor against a load that is moved by its angle."""
    plant = Drivetrain((0.02, 0.1), (Shaft(5000.0, 0.3, 0.01, "physical"),), locked="load")
    angle, _ = swing()
    law = lm.DiscreteSystem(
        inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",), D=np.array([[2.0, -2.0]]), dt=DT
    )
    loop = lm.simulate(plant, law=law, speed_reference=np.zeros(500), angle_load=angle, dt=DT)
    alone = lm.simulate(plant, torque_motor=loop["torque_motor"], angle_load=angle, dt=DT)
    np.testing.assert_array_equal(loop["torque_motor"], -2.0 * loop["speed_motor"])
    np.testing.assert_array_equal(loop["speed_motor"], alone["speed_motor"])
    assert loop["speed_motor"].any() and any(e.kind == "impact" for e in loop.events)


def test_a_held_end_does_not_turn_whatever_the_start():
    plant = Drivetrain((0.02, 0.1), (SHAFT,), locked="load")
    recording = lm.simulate(plant, torque_motor=np.full(50, 1.0), dt=DT, state=(0.0, 1.0, 5.0))
    assert not recording["speed_load"].any()


def test_moved_motor_drives_the_load():
    """A motor moved at constant speed equals a motor that is far heavier than the load."""
    held = Drivetrain((0.02, 0.1), (SHAFT,), (Friction(), Friction(1.0, 0.01)), locked="motor")
    heavy = Drivetrain((1e12, 0.1), (SHAFT,), (Friction(), Friction(1.0, 0.01)))
    moved = lm.simulate(held, torque_motor=np.zeros(1000), speed_motor=np.full(1000, 3.0), dt=DT)
    free = lm.simulate(heavy, torque_motor=np.zeros(1000), dt=DT, state=(0.0, 3.0, 0.0))
    np.testing.assert_allclose(moved["speed_load"], free["speed_load"], rtol=0.0, atol=1e-9)


def test_torque_by_index_equals_torque_by_name():
    plant = Drivetrain((0.02, 0.05, 0.1), (SHAFT, Shaft(8000.0, 0.2)))
    rng = np.random.default_rng(0)
    a, b = 10.0 * rng.standard_normal(300), 10.0 * rng.standard_normal(300)
    named = lm.simulate(plant, torque_motor=a, torque_load=b, dt=DT)
    numbered = lm.simulate(plant, torque_1=a, torque_3=b, dt=DT)
    np.testing.assert_array_equal(named["speed_load"], numbered["speed_load"])


def test_torque_into_the_middle_sets_all_in_motion():
    plant = Drivetrain((0.02, 0.05, 0.1), (SHAFT, Shaft(8000.0, 0.2)))
    recording = lm.simulate(plant, torque_2=np.full(500, 3.0), dt=DT)
    momentum = sum(
        j * recording[name]
        for j, name in zip(plant.inertias, ("speed_motor", "speed_2", "speed_load"), strict=True)
    )
    np.testing.assert_allclose(momentum, 3.0 * recording.time, rtol=0.0, atol=1e-13)


@pytest.mark.parametrize(
    "change",
    [
        {"torque_4": np.zeros(10)},
        {"torque_0": np.zeros(10)},
        {"speed_load": np.zeros(10)},
        {"torque_1": np.zeros(9)},
    ],
)
def test_inputs_that_do_not_exist_are_named(change):
    plant = Drivetrain((0.02, 0.05, 0.1), (SHAFT, SHAFT))
    with pytest.raises(lm.InvalidInput, match=r"simulate"):
        lm.simulate(plant, torque_motor=np.zeros(10), dt=DT, **change)


def test_only_ends_can_be_held():
    with pytest.raises(lm.InvalidInput, match=r"Drivetrain\.locked"):
        Drivetrain((1.0, 1.0), (SHAFT,), locked="middle")

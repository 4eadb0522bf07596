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

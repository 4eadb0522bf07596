"""Sure bounds of the total inertia, and friction from the slow motion, where shaft and gap do not matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.starts.slow_motion import (
    LEAST,
    SURE,
    SlowFriction,
    sure_inertia,
)
from lostmotion.identification.prediction_error.innovations import Predictor


@pytest.fixture
def known(flt: ContactFilter, plant: lm.Drivetrain) -> ContactFilter:
    return replace(flt, inertia=(plant.inertia_total, 0.01))


def test_friction_of_an_exact_drive(known: ContactFilter, flt: ContactFilter, plant: lm.Drivetrain):
    """Whether its inertia is known or not."""
    start = plant.with_parameters(inertia_load=0.2, inertia_motor=0.03)
    for one in (known, flt):
        slow = SlowFriction.of(one, start.pole_frequency)
        assert slow.coulomb == pytest.approx(2.0, rel=0.2)
    assert SlowFriction.of(known, start.pole_frequency) != SlowFriction.of(flt, start.pole_frequency)


def test_rest_and_reversals_are_no_lack_of_friction(plant: lm.Drivetrain):
    """At rest friction is whatever the torque is; and a speed that changes its sign is slow where its sign is not."""
    dt, time = 2e-4, np.arange(20_000) * 2e-4
    pushes = np.where(time % 2.0 < 1.0, 10.0 * np.sin(2.0 * np.pi * time), 0.0)
    fast = 12.0 * np.sign(np.sin(30.0 * np.pi * time)) + pushes
    for torque in (pushes, fast):
        run = lm.simulate(plant, torque_motor=torque, dt=dt)
        speed = run["speed_motor"] + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
        one = ContactFilter.of(Predictor(torque, speed, dt, False, plant, skip=0), 300.0)
        slow = SlowFriction.of(replace(one, inertia=(plant.inertia_total, 0.01)), plant.pole_frequency)
        assert slow.coulomb == pytest.approx(2.0, rel=0.2)


def test_a_drive_that_turns_one_way_alone_tells_no_coulomb_friction(plant: lm.Drivetrain):
    """A constant torque explains all: half of it each was a friction of 80 % of the torque, on a drive with 2 %."""
    dt, time = 2e-4, np.arange(20_000) * 2e-4
    torque = 8.0 + 4.0 * np.sin(8.0 * np.pi * time)
    speed = lm.simulate(plant, torque_motor=torque, dt=dt)["speed_motor"][2000:]
    speed = speed + 0.01 * np.random.default_rng(1).standard_normal(speed.size)
    one = ContactFilter.of(Predictor(torque[2000:], speed, dt, False, plant, skip=0), 300.0)
    slow = SlowFriction.of(replace(one, inertia=(plant.inertia_total, 0.01)), plant.pole_frequency)
    assert slow.coulomb < 0.05 and slow.constant == pytest.approx(2.0, rel=0.1)


def test_where_coulomb_friction_comes_out_negative_all_is_coulombs(
    known: ContactFilter, plant: lm.Drivetrain
):
    """Speeds near one size do not tell both kinds apart: with all of it viscous no descent came to the drive."""
    speed = np.gradient(known.measured, known.dt) if known.counted else known.measured
    size = float(np.mean(np.abs(speed)))
    # As much friction in the mean, but steeper over the speed than any line through the origin.
    steeper = replace(known, torque=known.torque + 3.0 * (speed / size - np.sign(speed)))
    slow = SlowFriction.of(steeper, plant.pole_frequency)
    assert 1.5 < slow.coulomb < 4.0 and slow.viscous * size < 0.1


def test_a_constant_torque_is_no_friction(known: ContactFilter, plant: lm.Drivetrain):
    pushed = SlowFriction.of(replace(known, torque=known.torque + 1.5), plant.pole_frequency)
    plain = SlowFriction.of(known, plant.pole_frequency)
    assert pushed.constant - plain.constant == pytest.approx(1.5, rel=1e-6)
    assert pushed.coulomb == pytest.approx(plain.coulomb, rel=1e-6)


def test_each_piece_is_filtered_for_itself(known: ContactFilter, plant: lm.Drivetrain):
    half = known.rows // 2
    two = replace(known, bounds=(0, half, known.rows))
    assert SlowFriction.of(two, plant.pole_frequency).coulomb == pytest.approx(2.0, rel=0.2)
    assert SlowFriction.of(two, plant.pole_frequency) != SlowFriction.of(known, plant.pole_frequency)


def test_the_total_inertia_is_sure_within_more_than_its_interval(plant: lm.Drivetrain):
    told = 1.1 * plant.inertia_total
    inertia, half = sure_inertia((told, 0.05), plant)
    assert inertia == told
    assert half == pytest.approx(np.hypot(SURE * 0.05, LEAST))
    assert sure_inertia((told, 0.0), plant)[1] == LEAST


@pytest.mark.parametrize("told", [4.0, 0.2, -1.0, np.nan])
def test_a_wild_inertia_gives_way_to_the_nameplate(told: float, plant: lm.Drivetrain):
    assert sure_inertia((told * plant.inertia_total, 0.1), plant) == (plant.inertia_total, np.inf)

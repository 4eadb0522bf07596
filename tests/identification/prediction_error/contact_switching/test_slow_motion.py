"""Total inertia and friction from the slow motion, where shaft and gap do not matter."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.slow_motion import SlowMotion


def test_total_inertia_and_friction_of_an_exact_drive(flt: ContactFilter, plant: lm.Drivetrain):
    slow = SlowMotion.of(flt, plant.with_parameters(inertia_load=0.2, inertia_motor=0.03))
    assert slow.inertia == pytest.approx(plant.inertia_total, rel=0.05)
    assert slow.coulomb == pytest.approx(2.0, rel=0.2)


def test_a_constant_load_torque_is_no_friction(flt: ContactFilter, plant: lm.Drivetrain):
    pushed = SlowMotion.of(replace(flt, torque=flt.torque + 1.5), plant)
    plain = SlowMotion.of(flt, plant)
    assert pushed.load_torque - plain.load_torque == pytest.approx(1.5, rel=1e-6)
    assert pushed.coulomb == pytest.approx(plain.coulomb, rel=1e-6)


def test_a_wild_inertia_gives_way_to_the_nameplate(flt: ContactFilter, plant: lm.Drivetrain):
    slow = SlowMotion.of(replace(flt, torque=10.0 * flt.torque), plant)
    assert slow.inertia == pytest.approx(plant.inertia_total)
    assert slow.half == np.inf


def test_each_piece_is_filtered_for_itself(flt: ContactFilter, plant: lm.Drivetrain):
    half = flt.rows // 2
    two = replace(flt, bounds=(0, half, flt.rows))
    assert SlowMotion.of(two, plant).inertia == pytest.approx(plant.inertia_total, rel=0.05)


def test_the_half_width_holds_and_grows_with_what_the_rigid_drive_leaves(
    flt: ContactFilter, plant: lm.Drivetrain
):
    plain = SlowMotion.of(flt, plant)
    assert abs(np.log(plain.inertia / plant.inertia_total)) < plain.half < 0.3
    time = flt.dt * np.arange(flt.rows)
    pushed = SlowMotion.of(replace(flt, torque=flt.torque + 3.0 * np.sin(6.0 * time)), plant)
    assert pushed.half > 1.3 * plain.half

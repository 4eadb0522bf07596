"""Total inertia and friction from the slow motion, where shaft and gap do not matter."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.slow_motion import SlowMotion

from .conftest import PLANT


def test_total_inertia_and_friction_of_an_exact_drive(flt: ContactFilter):
    slow = SlowMotion.of(flt, PLANT.with_parameters(inertia_load=0.2, inertia_motor=0.03))
    assert slow.inertia == pytest.approx(PLANT.inertia_total, rel=0.05)
    assert slow.coulomb == pytest.approx(2.0, rel=0.2)


def test_a_constant_load_torque_is_no_friction(flt: ContactFilter):
    pushed = SlowMotion.of(replace(flt, torque=flt.torque + 1.5), PLANT)
    plain = SlowMotion.of(flt, PLANT)
    assert pushed.load_torque - plain.load_torque == pytest.approx(1.5, rel=1e-6)
    assert pushed.coulomb == pytest.approx(plain.coulomb, rel=1e-6)


def test_a_wild_inertia_gives_way_to_the_nameplate(flt: ContactFilter):
    slow = SlowMotion.of(replace(flt, torque=10.0 * flt.torque), PLANT)
    assert slow.inertia == pytest.approx(PLANT.inertia_total)


def test_each_piece_is_filtered_for_itself(flt: ContactFilter):
    half = flt.rows // 2
    two = replace(flt, bounds=(0, half, flt.rows))
    assert SlowMotion.of(two, PLANT).inertia == pytest.approx(PLANT.inertia_total, rel=0.05)

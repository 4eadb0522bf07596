"""A third inertia: a descent finds it on its side of the gap, with a loss factor of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.third_inertia import (
    Place,
    places,
    with_third_inertia,
)

DT = 2e-4
FREE = ("inertia_motor", "inertia_load", "stiffness", "damping", "backlash", "coulomb")
TWO_MASSES = {
    "inertia_motor": 0.05, "inertia_load": 0.08, "stiffness": 3000.0, "damping": 0.6, "backlash": 0.01, "coulomb": 1.0,
    "motor_rate": 30.0, "load_rate": 10.0,
}  # fmt: skip


def recorded(behind: bool) -> ContactFilter:
    """20 bits of a chain with a joint of a tenth of the motor's or load's inertia beside the gap."""
    shafts = [lm.Shaft(9000.0, 3.0), lm.Shaft(4000.0, 0.3, backlash=0.01)]
    inertias, friction = [0.045, 0.005, 0.08], lm.Friction(1.0)
    if behind:
        shafts, inertias = shafts[::-1], [0.05, 0.008, 0.072]
    chain = lm.Drivetrain(inertias, shafts, (lm.Friction(), lm.Friction(), friction))
    torque = lm.signals.excitation(0.6, DT, seed=3, inertia=0.13, coulomb=1.0, viscous=0.0)
    count = 2.0 * np.pi / 2**20
    angle = np.floor(lm.simulate(chain, torque_motor=torque, dt=DT)["angle_motor"] / count) * count
    floor = count / np.sqrt(12.0)
    return ContactFilter(torque, angle, DT, True, floor, floor, 6, (0, torque.size))


@pytest.mark.parametrize("behind", [False, True], ids=["before the gap", "behind it"])
def test_a_descent_finds_it_on_its_side(behind: bool):
    flt = recorded(behind)
    theta = flt.theta(TWO_MASSES)
    free, box = sorted(INDEX[name] for name in FREE), Box.around(flt, theta, 30.0)
    two = polish(Candidate("two masses", theta, flt.run(theta).cost, flt, free), flt, box)
    found = polish(
        with_third_inertia(two, Place(0.1, 0.3, behind=behind), flt, box), replace(flt, behind=behind), box
    )
    assert found.cost < 0.2 < 0.5 < two.cost
    place = Place.of(found)
    assert place is not None and place.behind is behind and Place.of(two) is None
    assert place.share == pytest.approx(0.1, rel=0.05)
    assert place.compliance == pytest.approx(4000.0 / 13000.0, rel=0.05)
    assert found.start == "two masses"


def test_descents_start_on_either_side_of_the_gap():
    assert {place.behind for place in places()} == {False, True}
    assert len({(place.share, place.compliance) for place in places()}) == len(places()) / 2

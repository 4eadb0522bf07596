"""Which structure was taken, and what else would fit, in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.structures.in_words import parts_of
from lostmotion.identification.prediction_error.innovations import Predictor
from lostmotion.identification.prediction_error.result import Structure

PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.02,
    inertia_load=0.1,
    stiffness=6000.0,
    damping=0.4,
    backlash=0.012,
    coulomb=2.0,
    viscous=0.02,
)


@pytest.fixture(scope="module")
def flt() -> ContactFilter:
    random = np.random.default_rng(1).standard_normal((2, 2000))
    return ContactFilter.of(Predictor(10.0 * random[0], random[1], 1e-3, False, PLANT, skip=0), 100.0)


def candidate(flt: ContactFilter, start: str = "nameplate", **values: float) -> Candidate:
    own = {name: value for name, value in PLANT.parameters().items() if value}
    return Candidate(start, flt.theta({**own, **values}), 0.0, flt, [])


def test_parts_of_a_model(flt: ContactFilter):
    assert parts_of(candidate(flt)) == ("two masses", "a gap", "friction at the load")
    assert "no gap" in parts_of(candidate(flt, backlash=1e-6))
    assert "friction at both ends" in parts_of(candidate(flt, coulomb_motor=1.0))
    assert "friction at the motor" in parts_of(candidate(flt, coulomb_motor=1.0, coulomb=0.01))
    pushed = replace(candidate(flt), flt=replace(flt, torque=flt.torque - 3.0))
    assert "a constant torque" in parts_of(pushed)
    assert (
        parts_of(candidate(flt, share=0.1, compliance=0.3))[0]
        == "three masses, 10 % of the motor's on the shaft"
    )
    four = candidate(flt, share=0.1, compliance=0.3, share_fourth=0.2, compliance_fourth=0.3)
    assert parts_of(four)[0] == "four masses, two of the motor's on the shaft"
    either = replace(four, flt=replace(flt, fourth_behind=True))
    assert parts_of(either)[0] == "four masses, one on the shaft, one behind the gap"
    rigid = parts_of(candidate(flt, "rigid", backlash=0.0, coulomb_motor=1.0, coulomb=0.0))
    assert rigid == ("one rigid mass", "friction at the motor")
    other = replace(candidate(flt), flt=replace(flt, law="dead_zone", ramp=True))
    assert parts_of(other)[-2:] == ("the dead-zone contact", "a torque that goes straight from row to row")


def test_others_are_named_by_what_differs():
    own = ("two masses", "a gap", "friction at the load")
    others = (("two masses", "no gap", "friction at the load"), (*own, "a constant torque"))
    texts = Structure(own, others, compared=True).texts()
    assert texts["structure"] == "two masses, a gap, friction at the load"
    assert texts["would predict as well"] == "no gap, without a gap; a constant torque"
    assert Structure((), (), compared=True).texts()["structure"] == "none"
    assert Structure(own).texts()["would predict as well"] == "not compared"

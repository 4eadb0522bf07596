"""A race from a coarse grid finds the drive."""

from __future__ import annotations

from dataclasses import replace

import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, polish
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import pole_of
from lostmotion.identification.prediction_error.contact_switching.starts import grid
from lostmotion.identification.prediction_error.contact_switching.starts.race import NEXT, race
from lostmotion.identification.prediction_error.contact_switching.starts.slow_motion import informed


def test_the_race_finds_the_drive(flt: ContactFilter, plant: lm.Drivetrain):
    nameplate = plant.with_parameters(
        inertia_motor=0.03, inertia_load=0.2, stiffness=3500.0, backlash=0.03, coulomb=0.0
    )
    flt = informed(flt, (plant.inertia_total, 0.025), nameplate)
    part = replace(flt.liveliest(2000), charged=False)
    like = [flt.theta({"lag": 1.5e-4, "delay": 1.5e-4}), flt.theta({"lag": 1e-4, "delay": 1e-4})]
    begun = grid.candidates(part, nameplate, (), like)
    box = Box.around(part, begun[0].theta, 1e3)
    found = race(begun, part, box)
    assert [one.cost for one in found] == sorted(one.cost for one in found)
    assert len(found) == NEXT[-1][0] < len(begun)
    # Its backlash may be any: a scan finds that.
    best = polish(found[0], part, box)
    assert pole_of(best.theta) == pytest.approx(plant.pole_frequency, rel=0.01)

"""The grid with a gap and a third inertia begins at what two inertias have told."""

from __future__ import annotations

from dataclasses import replace

import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.structures import grid_of_three
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import THIRD


@pytest.fixture
def nameplate(plant: lm.Drivetrain) -> lm.Drivetrain:
    """Off by about two either way."""
    return plant.with_parameters(
        inertia_motor=0.03, inertia_load=0.2, stiffness=3500.0, backlash=0.03, coulomb=0.0
    )


def test_three_inertias_keep_what_two_have_told(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float], nameplate: lm.Drivetrain
):
    """Motor inertia, friction and lag; the slow motion gives the load's."""
    rows = replace(flt, inertia=(plant.inertia_total, 0.05))
    two = Candidate(
        "two", rows.theta(values), 0.0, replace(rows, law="limited", ramp=True), [0, INDEX["rise"]]
    )
    found = grid_of_three.candidates(two, rows, nameplate, ("stiffness",))
    size = len(grid_of_three.POLES) * len(grid_of_three.BACKLASHES) * len(grid_of_three.THIRDS)
    assert len(found) == size
    for one in found:
        for name in ("inertia_motor", "inertia_load", "coulomb", "viscous", "lag"):
            assert one.values[name] == pytest.approx(values[name])
        assert one.values["stiffness"] == pytest.approx(3500.0) and INDEX["stiffness"] not in one.free
        assert {*THIRD, INDEX["backlash"], INDEX["rise"]} <= {*one.free}
        assert one.flt.law == "limited" and one.flt.ramp
    places = {
        (round(one.values["share"], 3), round(one.values["compliance"], 3), one.flt.behind) for one in found
    }
    assert len(places) == len(grid_of_three.THIRDS)
    light = grid_of_three.candidates(
        two, replace(rows, inertia=(0.5 * values["inertia_motor"], 1.0)), nameplate, ()
    )
    assert all(
        one.values["inertia_load"] == pytest.approx(grid_of_three.LEAST_LOAD * values["inertia_motor"])
        for one in light
    )

"""The grid's points are drives with the recording's own inertia, and one of them lies near the truth."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching import grid
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter, pole_of
from lostmotion.identification.prediction_error.contact_switching.likelihood import (
    Box,
    Candidate,
    descend,
    polish,
)
from lostmotion.identification.prediction_error.contact_switching.starts import free_places


@pytest.fixture
def nameplate(plant: lm.Drivetrain) -> lm.Drivetrain:
    """Off by about two either way."""
    return plant.with_parameters(
        inertia_motor=0.03, inertia_load=0.2, stiffness=3500.0, backlash=0.03, coulomb=0.0
    )


def test_all_points_have_the_same_total_inertia(flt: ContactFilter, nameplate: lm.Drivetrain):
    totals = [np.exp(np.logaddexp(*point.theta[:2])) for point in grid.points(flt, nameplate, ())]
    assert np.ptp(totals) < 1e-9 * np.mean(totals)
    assert len(totals) == len(grid.RATIOS) * len(grid.POLES) * len(grid.BACKLASHES) * len(grid.AT_MOTOR)


def test_what_is_fixed_keeps_the_nameplate(flt: ContactFilter, nameplate: lm.Drivetrain):
    for point in grid.points(flt, nameplate, ("stiffness", "coulomb")):
        assert np.exp(point.theta[INDEX["stiffness"]]) == pytest.approx(3500.0)
        assert point.theta[INDEX["coulomb"]] == point.theta[INDEX["coulomb_motor"]] == -np.inf


def test_each_plane_of_the_grid_has_its_best(flt: ContactFilter, nameplate: lm.Drivetrain):
    part = flt.liveliest(2000)
    found = grid.best(part, nameplate, ())
    assert len(found) <= len(grid.RATIOS) + len(grid.POLES) + len(grid.BACKLASHES) + len(grid.AT_MOTOR)
    motors = {round(float(theta[INDEX["inertia_motor"]]), 6) for theta in found}
    assert len(motors) == len(grid.RATIOS)


def test_a_descent_from_the_grid_finds_the_drive(
    flt: ContactFilter, plant: lm.Drivetrain, nameplate: lm.Drivetrain
):
    part = flt.liveliest(3000)
    free = free_places(nameplate, ())

    def end(first: np.ndarray) -> Candidate:
        return descend("grid", part, first, free, Box.around(part, first, 100.0), iterations=3)

    found = min((end(first) for first in grid.best(part, nameplate, ())), key=lambda one: one.cost)
    found = polish(found, part, Box.around(part, found.theta, 100.0))
    assert pole_of(found.theta) == pytest.approx(plant.pole_frequency, rel=0.01)
    assert found.cost < 0.3

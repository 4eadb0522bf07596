"""The grid's points are drives with the recording's own inertia, and one of them lies near the truth."""

from __future__ import annotations

import numpy as np

from lostmotion.identification.prediction_error.contact_switching import grid
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter, pole_of
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, minimise
from lostmotion.identification.prediction_error.contact_switching.starts import free_places

from .conftest import PLANT

#: A nameplate that is off by two either way.
NAMEPLATE = PLANT.with_parameters(
    inertia_motor=0.03, inertia_load=0.2, stiffness=3500.0, backlash=0.03, coulomb=0.0
)


def test_all_points_have_the_same_total_inertia(flt: ContactFilter):
    totals = [np.exp(np.logaddexp(*point.theta[:2])) for point in grid.points(flt, NAMEPLATE, ())]
    assert np.ptp(totals) < 1e-9 * np.mean(totals)
    assert len(totals) == len(grid.RATIOS) * len(grid.POLES) * len(grid.BACKLASHES) * len(grid.AT_MOTOR)


def test_what_is_fixed_keeps_the_nameplate(flt: ContactFilter):
    for point in grid.points(flt, NAMEPLATE, ("stiffness", "coulomb")):
        assert np.exp(point.theta[INDEX["stiffness"]]) == np.float64(np.exp(np.log(3500.0)))
        assert point.theta[INDEX["coulomb"]] == -np.inf


def test_each_plane_of_the_grid_has_its_best(flt: ContactFilter):
    part = flt.liveliest(2000)
    found = grid.best(part, NAMEPLATE, ())
    assert len(found) <= len(grid.RATIOS) + len(grid.POLES) + len(grid.BACKLASHES) + len(grid.AT_MOTOR)
    motors = {round(float(theta[INDEX["inertia_motor"]]), 6) for theta in found}
    assert len(motors) == len(grid.RATIOS)


def test_a_descent_from_the_grid_finds_the_drive(flt: ContactFilter):
    part = flt.liveliest(3000)
    free, first = free_places(NAMEPLATE, ()), grid.best(part, NAMEPLATE, ())[0]
    theta, _ = minimise(part, first, free, Box.around(part, first, 100.0), 20)
    assert pole_of(theta) == np.float64(pole_of(theta))
    assert abs(np.log(pole_of(theta) / PLANT.pole_frequency)) < 0.1

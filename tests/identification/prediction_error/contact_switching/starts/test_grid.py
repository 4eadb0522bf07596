"""The grid's points are drives with the recording's own inertia, and one of them lies near the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter, pole_of
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, polish
from lostmotion.identification.prediction_error.contact_switching.starts import grid
from lostmotion.identification.prediction_error.contact_switching.starts.slow_motion import informed


@pytest.fixture
def nameplate(plant: lm.Drivetrain) -> lm.Drivetrain:
    """Off by about two either way."""
    return plant.with_parameters(
        inertia_motor=0.03, inertia_load=0.2, stiffness=3500.0, backlash=0.03, coulomb=0.0
    )


def two_lags(flt: ContactFilter) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Half of the true lag each, and half a sample each."""
    true, half = 1.5e-4, 0.5 * flt.dt
    return flt.theta({"lag": true, "delay": true}), flt.theta({"lag": half, "delay": half})


def test_all_points_have_the_same_total_inertia(flt: ContactFilter, nameplate: lm.Drivetrain):
    totals = [np.exp(np.logaddexp(*theta[:2])) for theta in grid.points(flt, nameplate, (), two_lags(flt))]
    assert np.ptp(totals) < 1e-9 * np.mean(totals)
    assert len(totals) == len(grid.RATIOS) * len(grid.POLES) * len(grid.BACKLASHES)


def test_what_is_fixed_keeps_the_nameplate(flt: ContactFilter, nameplate: lm.Drivetrain):
    for theta in grid.points(flt, nameplate, ("stiffness", "coulomb"), two_lags(flt)):
        assert np.exp(theta[INDEX["stiffness"]]) == pytest.approx(3500.0)
        assert theta[INDEX["coulomb"]] == theta[INDEX["coulomb_motor"]] == 0.0


def test_lag_and_delay_are_those_of_two_starts_in_turn(flt: ContactFilter, nameplate: lm.Drivetrain):
    """Neighbours in the grid have either, so that each ratio, pole and gap is tried with both."""
    like, lags = two_lags(flt), [INDEX["lag"], INDEX["delay"]]
    taken = [
        [bool(np.all(theta[lags] == one[lags])) for one in like]
        for theta in grid.points(flt, nameplate, (), like)
    ]
    assert all(sum(each) == 1 for each in taken)
    first = np.array(taken)[:, 0].reshape(len(grid.RATIOS), len(grid.POLES), len(grid.BACKLASHES))
    assert all(np.all(np.diff(first.astype(int), axis=axis) != 0) for axis in range(3))


def test_the_race_finds_the_drive(flt: ContactFilter, plant: lm.Drivetrain, nameplate: lm.Drivetrain):
    flt = informed(flt, (plant.inertia_total, 0.025), nameplate)
    part = replace(flt.liveliest(2000), charged=False)
    like = two_lags(flt)
    box = Box.around(part, next(grid.points(part, nameplate, (), like)), 1e3)
    found = grid.race(part, nameplate, (), like, box)
    assert [one.cost for one in found] == sorted(one.cost for one in found)
    assert len(found) == grid.NEXT[-1][0]
    # Its backlash may be any: the scan finds that.
    best = polish(found[0], part, box)
    assert pole_of(best.theta) == pytest.approx(plant.pole_frequency, rel=0.01)

"""The grid's points are drives with the recording's own inertia, and one of them lies near the truth."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.starts import grid


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


def test_candidates_are_the_points_over_some_rows(flt: ContactFilter, nameplate: lm.Drivetrain):
    found = grid.candidates(flt, nameplate, ("stiffness",), two_lags(flt))
    points = list(grid.points(flt, nameplate, ("stiffness",), two_lags(flt)))
    assert all(np.array_equal(one.theta, theta) for one, theta in zip(found, points, strict=True))
    assert all(one.flt is flt and INDEX["stiffness"] not in one.free for one in found)

"""The search over starts: what is displaced comes back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.choices import with_other_torque
from lostmotion.identification.prediction_error.contact_switching.descents import DISPLACED, Search
from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD, distance
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate, polish


@pytest.fixture
def search(flt: ContactFilter, plant: lm.Drivetrain) -> Search:
    start = plant.with_parameters(stiffness=0.5 * plant.stiffness)
    return replace(
        Search.of(flt, start, plant, (), None, (plant.inertia_total, 0.05)), part=flt.liveliest(3000)
    )


@pytest.fixture
def best(search: Search, values: dict[str, float]) -> Candidate:
    theta = search.part.theta(values)
    free = sorted(INDEX[name] for name in TOLD)
    return Candidate("truth", theta, search.part.run(theta).cost, search.part, free)


def test_what_is_displaced_from_the_truth_comes_back(search: Search, best: Candidate):
    found = search.displaced(best)
    assert len(found) > 2 * len(DISPLACED)
    lowest = min(found, key=lambda one: one.cost)
    assert np.max(distance(lowest, best)[:5]) < 0.01


def test_another_backlash_is_found_from_beside_the_truth(
    search: Search, best: Candidate, plant: lm.Drivetrain
):
    """No descent leads from 30 times the backlash to it."""
    theta = search.part.changed(best.theta, backlash=30.0 * plant.backlash)
    wide = polish(replace(best, theta=theta), best.flt, search.box)
    assert distance(wide, best)[TOLD.index("backlash")] > 1.0
    lowest = min(search.displaced(wide), key=lambda one: one.cost)
    assert np.max(distance(lowest, best)[:5]) < 0.01


def test_descents_from_the_grid_are_judged_by_one_likelihood(search: Search):
    """They come down with innovations divided out: their cost would be too low beside the others'."""
    found = search.from_grid()
    assert len({one.start for one in found}) == len(found) > 1
    for one in found:
        assert one.flt.charged and one.flt.rows == search.part.rows
        assert one.cost == pytest.approx(one.flt.run(one.theta).cost, abs=1e-12)


def test_a_held_torque_is_told_from_one_that_goes_straight_from_row_to_row(search: Search, best: Candidate):
    """This recording's is a command: a ramp is no better, and from a ramp the search comes back to it."""
    assert with_other_torque(best, search.box) is None
    ramp = replace(best.flt, ramp=True)
    held = with_other_torque(replace(best, flt=ramp, cost=ramp.run(best.theta).cost), search.box)
    assert held is not None and not held.flt.ramp
    assert held.over(ramp).ramp is False

"""A backlash that is far off is found by a scan where no descent finds it."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.backlash_scan import (
    SCAN,
    with_other_backlash,
)
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.starts import free_places


@pytest.fixture
def narrow(flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float]) -> Candidate:
    """The drive with a hundredth of its backlash."""
    part = flt.liveliest(2000)
    theta = part.theta({**values, "backlash": 0.01 * plant.backlash})
    return Candidate("narrow", theta, part.run(theta).cost, part, free_places(plant, ()))


def test_a_wide_gap_is_found_from_a_narrow_one(narrow: Candidate, plant: lm.Drivetrain):
    box = Box.around(narrow.flt, narrow.theta, 1e4)
    found = with_other_backlash([narrow], box)
    assert len(found) == len(SCAN)
    best = polish(min(found, key=lambda one: one.cost), narrow.flt, box)
    stuck = polish(narrow, narrow.flt, box)
    assert np.exp(best.theta[INDEX["backlash"]]) == pytest.approx(plant.backlash, rel=0.02)
    assert best.cost < stuck.cost - 0.1


def test_without_a_gap_there_is_nothing_to_scan(narrow: Candidate):
    free = [place for place in narrow.free if place != INDEX["backlash"]]
    gapless = Candidate("gapless", narrow.theta, narrow.cost, narrow.flt, free)
    assert with_other_backlash([gapless], Box.around(narrow.flt, narrow.theta, 1e4)) == []

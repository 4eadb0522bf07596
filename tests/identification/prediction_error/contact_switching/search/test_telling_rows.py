"""The part of a recording in which a drive shows most of itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import CORE, TOLD, scatter
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.search.telling_rows import most_telling
from lostmotion.identification.prediction_error.contact_switching.structures.no_gap import bare

DT, HALF = 2e-4, 5000


def _one_way_then_to_and_fro(seen: Callable, plant: lm.Drivetrain) -> ContactFilter:
    """A large torque that never lets the gap open, then a smaller one that crosses it."""
    time = DT * np.arange(2 * HALF)
    one_way = 25.0 + 12.0 * np.sin(2.0 * np.pi * 20.0 * time)
    to_and_fro = lm.signals.excitation(HALF * DT, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    return seen(plant, np.concatenate([one_way, 0.5 * to_and_fro]), None, 300.0)


@pytest.mark.parametrize("gap", [True, False])
def test_rows_that_cross_the_gap_or_ring_tell_more_than_lively_ones(
    seen: Callable, plant: lm.Drivetrain, values: dict[str, float], gap: bool
):
    flt = _one_way_then_to_and_fro(seen, plant if gap else plant.with_parameters(backlash=0.0))
    drive = Candidate("truth", flt.theta(values), 0.0, flt, sorted(INDEX[name] for name in TOLD))
    drive = drive if gap else bare(drive)
    parts = flt.liveliest(HALF), most_telling(drive, flt, HALF)
    lively, telling = (
        scatter(Candidate("truth", drive.theta, 0.0, part, drive.free))[1][CORE] for part in parts
    )
    has = telling > 0.0
    assert np.sum(has) == len(CORE) - (not gap)
    assert np.all(telling[has] < 0.1 * lively[has])
    assert np.all(telling < 1e-2)
    assert parts[1].rows == HALF and parts[1].whole is flt


def test_all_rows_are_taken_where_there_are_no_more(flt: ContactFilter, values: dict[str, float]):
    drive = Candidate("truth", flt.theta(values), 0.0, flt, sorted(INDEX[name] for name in TOLD))
    assert most_telling(drive, flt, flt.rows) is flt

"""The part of a recording in which a drive shows most of itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import CORE, TOLD, scatter
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.search.telling_rows import most_telling

DT, HALF = 2e-4, 5000


def _one_way_then_to_and_fro(seen: Callable, plant: lm.Drivetrain) -> ContactFilter:
    """A large torque that never lets the gap open, then a smaller one that crosses it."""
    time = DT * np.arange(2 * HALF)
    one_way = 25.0 + 12.0 * np.sin(2.0 * np.pi * 20.0 * time)
    to_and_fro = lm.signals.excitation(HALF * DT, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    return seen(plant, np.concatenate([one_way, 0.5 * to_and_fro]), None, 300.0)


def test_rows_that_cross_the_gap_tell_more_than_lively_ones(
    seen: Callable, plant: lm.Drivetrain, values: dict[str, float]
):
    flt = _one_way_then_to_and_fro(seen, plant)
    drive = Candidate("truth", flt.theta(values), 0.0, flt, sorted(INDEX[name] for name in TOLD))
    parts = flt.liveliest(HALF), most_telling(drive, flt, HALF)
    lively, telling = (
        scatter(Candidate("truth", drive.theta, 0.0, part, drive.free))[1][CORE] for part in parts
    )
    assert np.all(telling < 0.1 * lively)
    assert np.all(telling < 1e-2)
    assert parts[1].rows == HALF and parts[1].whole is flt


def test_all_rows_are_taken_where_there_are_no_more(flt: ContactFilter, values: dict[str, float]):
    drive = Candidate("truth", flt.theta(values), 0.0, flt, sorted(INDEX[name] for name in TOLD))
    assert most_telling(drive, flt, flt.rows) is flt

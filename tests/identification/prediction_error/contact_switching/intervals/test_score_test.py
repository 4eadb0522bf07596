"""Room for a part that the model lacks, of innovations that are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.intervals.score_test import (
    change_by,
    room_by_score,
    shows,
)
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX

STIFFNESS = TOLD.index("stiffness")


@pytest.fixture(scope="module")
def best(flt: ContactFilter, values: dict[str, float]) -> Candidate:
    return Candidate("truth", flt.theta(values), 0.0, flt, [INDEX["inertia_motor"], INDEX["stiffness"]])


def test_what_a_parameter_makes_up_for_changes_it_as_much_as_there_may_be(best: Candidate):
    """Nothing is left that would show it."""
    effect = 0.3 * best.run.jacobian[1]
    room = room_by_score(best, [(effect, None)], 0.5)
    assert room[STIFFNESS] == pytest.approx(0.15, rel=1e-6)
    assert np.delete(room, STIFFNESS) == pytest.approx(0.0, abs=1e-6)
    own = np.zeros(len(TOLD))
    own[STIFFNESS] = 0.3  # makes up for it
    assert room_by_score(best, [(effect, own)], 0.5) == pytest.approx(0.0, abs=1e-6)


def test_what_shows_changes_nothing_but_by_chance(best: Candidate):
    shown = np.random.default_rng(1).standard_normal(best.run.weighted.size)
    own = np.ones(len(TOLD))
    room = room_by_score(best, [(shown, own)], 1.0)
    assert np.all(room < 5.0 / np.sqrt(shown.size))
    there = replace(best)
    there.__dict__["run"] = replace(best.run, weighted=best.run.weighted + 0.1 * shown)
    assert np.all(np.abs(room_by_score(there, [(shown, own)], 1.0) - 0.1) < 0.03)


def test_an_effect_that_is_not_finite_says_nothing(best: Candidate):
    effect = np.full(best.run.weighted.size, np.inf)
    assert not np.any(room_by_score(best, [(effect, None)], 1.0))


def test_a_change_keeps_the_deviations(best: Candidate):
    other = best.flt.run(best.flt.changed(best.theta, stiffness=1.01 * best.values["stiffness"]))
    louder = replace(other, weighted=other.weighted / 2.0, deviations=2.0 * other.deviations)
    assert change_by(louder, best.run) == pytest.approx(change_by(other, best.run))
    assert change_by(best.run, best.run) == pytest.approx(0.0, abs=1e-12)


def test_an_effect_shows_beside_what_parameters_make_up_for(best: Candidate):
    """One alone of several, by so much that it is no chance; not what a parameter does as well."""
    rng = np.random.default_rng(1)
    effect, other = rng.standard_normal((2, best.run.weighted.size))
    made_up = 0.3 * best.run.jacobian[1]
    noise = replace(best.run, weighted=rng.standard_normal(effect.size))

    def with_part(part: float) -> Candidate:
        there = replace(best)
        there.__dict__["run"] = replace(noise, weighted=noise.weighted + part * effect + 100.0 * made_up)
        return there

    assert not shows(with_part(0.0), [effect, other, made_up])
    assert shows(with_part(8.0 / np.sqrt(effect.size)), [other, effect, made_up])
    assert not shows(with_part(0.0), [np.full(effect.size, np.inf), np.zeros(effect.size)])
    assert not shows(with_part(0.0), [])

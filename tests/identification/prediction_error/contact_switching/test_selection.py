"""The best of many candidates has to stand out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.selection import apart, stands_out


@pytest.fixture
def best(flt: ContactFilter, values: dict[str, float]) -> Candidate:
    part = flt.liveliest(3000)
    theta = part.theta(values)
    return Candidate("truth", theta, part.run(theta).cost, part, sorted(INDEX[name] for name in TOLD))


def test_the_beststands_out_where_what_predicts_alike_agrees_with_it(best: Candidate):
    theta = best.theta.copy()
    theta[[INDEX["inertia_load"], INDEX["stiffness"]]] += 2.0
    elsewhere = replace(best, theta=theta)
    assert stands_out([best, replace(best, start="again")])
    assert stands_out([best, replace(elsewhere, cost=best.cost + 0.5)])
    assert not stands_out([best, elsewhere])


def test_of_candidates_that_are_one_the_first_stays(best: Candidate):
    near, far = best.theta.copy(), best.theta.copy()
    near[INDEX["backlash"]] += 0.005
    far[INDEX["backlash"]] += 0.5
    others = [replace(best, theta=theta) for theta in (near, far)]
    assert apart([best, *others]) == [best, others[1]]
    assert apart([best, *others], 1.0) == [best]

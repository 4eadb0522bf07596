"""Which candidates lie apart, and which may be right."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.selection import (
    apart,
    plausible,
)


@pytest.fixture
def best(flt: ContactFilter, values: dict[str, float]) -> Candidate:
    part = flt.liveliest(3000)
    theta = part.theta(values)
    return Candidate("truth", theta, part.run(theta).cost, part, sorted(INDEX[name] for name in TOLD))


def test_of_candidates_that_are_one_the_first_stays(best: Candidate):
    near, far = best.theta.copy(), best.theta.copy()
    near[INDEX["backlash"]] += 0.005
    far[INDEX["backlash"]] += 0.5
    others = [replace(best, theta=theta) for theta in (near, far)]
    assert apart([best, *others]) == [best, others[1]]
    assert apart([best, *others], 1.0) == [best]


def test_a_descent_with_more_parts_that_predicts_worse_has_failed(best: Candidate):
    """A third inertia 9 % off, with a cost of 0.20, beside the same drive without one, with 0.16, hid three right
    values of drive 1520."""
    share = best.flt.changed(best.theta, share=0.4, compliance=0.1, loss=1.0)
    law = replace(best.flt, law="clipped")
    first = replace(best, cost=0.1535, flt=law)
    plain, third = replace(best, cost=0.16), replace(best, cost=0.2, theta=share)
    assert third.contains(plain) and not plain.contains(third) and not third.contains(first)
    assert plausible([third, plain, first]) == [first, plain]
    assert plausible([third, first]) == [first, third]
    behind = replace(third, flt=replace(best.flt, behind=True))
    assert not behind.contains(third) and behind.contains(plain)

"""What the best candidate tells: where it is silent, and what widens its intervals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching import estimate
from lostmotion.identification.prediction_error.contact_switching.estimate import (
    COHERENT,
    CORE,
    DISAGREEMENT,
    EXACT,
    EXPLAINED,
    TOLD,
    WIDEST,
    distance,
    sharp,
    told,
)
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate

#: All fits of the model agree.
NOTHING = np.zeros(len(TOLD))


@pytest.fixture
def best(flt: ContactFilter, values: dict[str, float]) -> Candidate:
    """The truth, over some rows."""
    part = flt.liveliest(4000)
    theta = part.theta(values)
    free = sorted(INDEX[name] for name in TOLD)
    return Candidate("truth", theta, part.run(theta).cost, part, free)


def without(one: Candidate, name: str) -> Candidate:
    theta = one.theta.copy()
    theta[INDEX[name]] = -np.inf
    return replace(one, theta=theta)


def box(one: Candidate) -> Box:
    return Box.around(one.flt, one.theta, 100.0)


def test_a_value_that_only_one_has_is_infinitely_far(best: Candidate):
    place = TOLD.index("backlash")
    assert distance(best, without(best, "backlash"))[place] == np.inf
    assert distance(without(best, "backlash"), without(best, "backlash"))[place] == 0.0


def test_the_truth_is_told_with_narrow_intervals(best: Candidate):
    found = told(best, [best], NOTHING, box(best), ())
    assert np.all(found.half[CORE] < 0.1)


def test_sharp_is_what_explains_many_rows(best: Candidate):
    few = best.flt.part(slice(0, 60))
    assert sharp(best)
    assert not sharp(replace(best, cost=EXPLAINED)) and not sharp(replace(best, flt=few))


def test_what_is_left_unexplained_widens_all(best: Candidate):
    plain, cost = told(best, [best], NOTHING, box(best), ()), 0.5
    poor = told(replace(best, cost=cost), [best], NOTHING, box(best), ())
    growth = np.hypot(1.0, COHERENT * np.sqrt(best.flt.counting.size * np.expm1(2.0 * cost)))
    before = np.hypot(1.0, COHERENT * np.sqrt(best.flt.counting.size * np.expm1(2.0 * abs(best.cost))))
    wide, narrow = (np.sqrt(one.half[:3] ** 2 - EXACT**2) for one in (poor, plain))
    assert wide / narrow == pytest.approx(growth / before)


def test_what_predicts_as_well_belongs_to_the_interval(best: Candidate):
    theta = best.theta.copy()
    theta[INDEX["stiffness"]] += 0.3
    found = told(best, [best, replace(best, theta=theta)], NOTHING, box(best), ())
    assert found.half[TOLD.index("stiffness")] >= 0.3


def test_what_other_fits_disagree_about_belongs_to_the_interval(best: Candidate):
    apart = np.where(np.array(TOLD) == "stiffness", 0.05, 0.0)
    plain = told(best, [best], NOTHING, box(best), ())
    found = told(best, [best], apart, box(best), ())
    expected = np.hypot(plain.half, DISAGREEMENT * apart)
    assert found.half == pytest.approx(expected)
    wide = told(best, [best], apart * WIDEST / (0.9 * DISAGREEMENT * 0.05), box(best), ())
    assert np.flatnonzero(np.isinf(wide.half)).tolist() == [TOLD.index("stiffness")]


def test_a_wide_interval_is_told_up_to_its_limit(best: Candidate):
    apart = np.where(np.array(TOLD) == "stiffness", 0.9 * WIDEST / DISAGREEMENT, 0.0)
    found = told(best, [best], apart, box(best), ())
    assert found.half[TOLD.index("stiffness")] == pytest.approx(0.9 * WIDEST, rel=1e-3)


def test_a_torque_from_row_to_row_leaves_half_a_row_of_lag_open(best: Candidate):
    ramp = told(replace(best, flt=replace(best.flt, ramp=True)), [best], NOTHING, box(best), ())
    dt, lag = best.flt.dt, np.exp(ramp.theta[-1]) - best.flt.dt
    assert np.exp(ramp.theta[-1] - ramp.half[-1]) - dt < lag - 0.5 * dt
    assert told(best, [best], NOTHING, box(best), ()).half[-1] < 0.5 * ramp.half[-1]


def test_what_is_fixed_or_at_a_bound_is_not_told(best: Candidate):
    bounds = box(best)
    bounds.upper[INDEX["inertia_motor"]] = best.theta[INDEX["inertia_motor"]]
    found = told(best, [best], NOTHING, bounds, ("coulomb",))
    assert np.isinf(found.half[[TOLD.index("coulomb"), TOLD.index("inertia_motor")]]).all()


def test_of_load_spring_and_gap_one_alone_is_not_told(best: Candidate):
    theta = best.theta.copy()
    theta[[INDEX["inertia_load"], INDEX["stiffness"]]] += 0.5
    both = [best, replace(best, theta=theta)]
    assert np.isinf(told(best, both, NOTHING, box(best), ()).half).all()
    # What is fixed is known.
    found = told(best, both, NOTHING, box(best), ("stiffness",))
    assert np.isfinite(found.half[[TOLD.index("inertia_motor"), TOLD.index("backlash")]]).all()


def test_what_is_not_explained_may_hide_a_gap(best: Candidate, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(estimate, "without_gap", lambda one, _: one)
    monkeypatch.setattr(estimate, "gap_bound", lambda *_: 0.5)
    found = told(best, [best], NOTHING, box(best), ())
    for cost, bound in ((-0.1, 0.5), (0.09, 0.5), (0.11, None), (-0.3, None)):
        one = estimate._without_gap(replace(found, best=replace(best, cost=cost)), [best], box(best))
        assert one.gap_bound == bound, cost


def test_a_third_inertia_leaves_damping_open_as_far_as_innovations_are_left(best: Candidate):
    theta = best.theta.copy()
    theta[[INDEX["share"], INDEX["compliance"], INDEX["loss"]]] = np.log([0.2, 0.1, 1.0])
    third = replace(best, theta=theta)
    place = TOLD.index("damping")
    left, none = (replace(third, cost=cost) for cost in (2.0, 0.0))
    assert told(left, [left], NOTHING, box(best), ()).half[place] >= 0.49
    assert told(none, [none], NOTHING, box(best), ()).half[place] < 0.2

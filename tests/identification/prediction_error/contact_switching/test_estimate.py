"""What the best candidate tells: where it is silent, and what widens its intervals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching import estimate
from lostmotion.identification.prediction_error.contact_switching.estimate import (
    APART,
    COHERENT,
    CORE,
    EXPLAINED,
    TOLD,
    distance,
    sharp,
    told,
)
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.structures.division import (
    room_for_division,
)
from lostmotion.identification.prediction_error.identifiability import WIDEST

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
    found = told(best, [best], NOTHING, NOTHING, box(best), ())
    assert np.all(found.half[CORE] < 0.1)


def test_sharp_is_what_explains_many_rows(best: Candidate):
    few = best.flt.part(slice(0, 60))
    assert sharp(best)
    assert not sharp(replace(best, cost=EXPLAINED)) and not sharp(replace(best, flt=few))


def test_what_is_left_unexplained_widens_all(best: Candidate):
    plain, cost = told(best, [best], NOTHING, NOTHING, box(best), ("backlash",)), 0.5
    worse = replace(best, cost=cost)
    poor = told(worse, [best], NOTHING, NOTHING, box(best), ("backlash",))
    growth = np.hypot(1.0, COHERENT * np.sqrt(best.flt.counting.size * np.expm1(2.0 * cost)))
    before = np.hypot(1.0, COHERENT * np.sqrt(best.flt.counting.size * np.expm1(2.0 * abs(best.cost))))
    assert poor.half[:3] / plain.half[:3] == pytest.approx(growth / before)


def test_what_predicts_as_well_belongs_to_the_interval(best: Candidate):
    theta = best.theta.copy()
    theta[INDEX["stiffness"]] += 0.3
    found = told(best, [best, replace(best, theta=theta)], NOTHING, NOTHING, box(best), ())
    assert found.half[TOLD.index("stiffness")] >= 0.3


def test_what_other_fits_disagree_about_belongs_to_the_interval(best: Candidate):
    apart = np.where(np.array(TOLD) == "stiffness", 0.05, 0.0)
    plain = told(best, [best], NOTHING, NOTHING, box(best), ())
    found = told(best, [best], apart, NOTHING, box(best), ())
    expected = np.hypot(plain.half, apart)
    assert found.half == pytest.approx(expected)
    wide = told(best, [best], apart * WIDEST / (0.9 * 0.05), NOTHING, box(best), ())
    assert np.flatnonzero(np.isinf(wide.half)).tolist() == [TOLD.index("stiffness")]


def test_a_wide_interval_is_told_up_to_its_limit(best: Candidate):
    apart = np.where(np.array(TOLD) == "stiffness", 0.9 * APART, 0.0)
    found = told(best, [best], apart, NOTHING, box(best), ())
    assert found.half[TOLD.index("stiffness")] == pytest.approx(0.9 * APART, rel=1e-3)


@pytest.mark.parametrize("name, limit", [("damping", WIDEST), ("coulomb", WIDEST), ("backlash", APART)])
def test_nothing_is_told_whose_interval_is_wider_than_the_limit(best: Candidate, name: str, limit: float):
    for part, is_told in ((0.9, True), (1.1, False)):
        apart = np.where(np.array(TOLD) == name, part * limit, 0.0)
        half = told(best, [best], apart, NOTHING, box(best), ()).half
        assert np.isfinite(half[TOLD.index(name)]) == is_told, (part, half)


def test_a_gap_below_a_count_is_not_told(best: Candidate, monkeypatch: pytest.MonkeyPatch):
    """It acts through its uncertain impacts alone: one of a sixth of a count was 34 % wide, and the true one 1500 times
    larger."""
    monkeypatch.setattr(estimate, "alike", lambda *_: False)
    count = np.sqrt(12.0) * best.flt.position_noise
    for part, is_told in ((1.1, True), (0.9, False)):
        theta = best.flt.changed(best.theta, backlash=part * count)
        one = replace(best, theta=theta, cost=best.flt.run(theta).cost)
        assert estimate._other_does_as_well(one, "backlash") is not is_told
        assert not estimate._other_does_as_well(one, "damping")


def test_a_torque_from_row_to_row_leaves_half_a_row_of_lag_open(best: Candidate):
    ramp = told(replace(best, flt=replace(best.flt, ramp=True)), [best], NOTHING, NOTHING, box(best), ())
    dt, lag = best.flt.dt, np.exp(ramp.theta[-1]) - best.flt.dt
    assert np.exp(ramp.theta[-1] - ramp.half[-1]) - dt < lag - 0.5 * dt
    assert told(best, [best], NOTHING, NOTHING, box(best), ()).half[-1] < 0.5 * ramp.half[-1]


def test_what_is_fixed_or_at_a_bound_is_not_told(best: Candidate):
    bounds = box(best)
    bounds.upper[INDEX["inertia_motor"]] = best.theta[INDEX["inertia_motor"]]
    found = told(best, [best], NOTHING, NOTHING, bounds, ("coulomb",))
    assert np.isinf(found.half[[TOLD.index("coulomb"), TOLD.index("inertia_motor")]]).all()


def test_of_load_spring_and_gap_one_alone_is_not_told(best: Candidate):
    theta = best.theta.copy()
    theta[[INDEX["inertia_load"], INDEX["stiffness"]]] += 0.5
    both = [best, replace(best, theta=theta)]
    assert np.isinf(told(best, both, NOTHING, NOTHING, box(best), ()).half).all()
    # What is fixed is known.
    found = told(best, both, NOTHING, NOTHING, box(best), ("stiffness",))
    assert np.isfinite(found.half[[TOLD.index("inertia_motor"), TOLD.index("backlash")]]).all()


def test_what_is_not_explained_may_hide_a_gap(best: Candidate, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(estimate, "without_gap", lambda one, _: one)
    monkeypatch.setattr(estimate, "gap_bound", lambda *_: 0.5)
    found = replace(told(best, [best], NOTHING, NOTHING, box(best), ()), gap_bound=None)
    for cost, bound in ((-0.1, 0.5), (0.03, 0.5), (0.05, None), (-0.3, None)):
        unexplained = replace(found, best=replace(best, cost=cost))
        one = estimate._where_no_gap_shows(unexplained, [best], box(best), ())
        assert one.gap_bound == bound, cost


def test_room_for_further_inertias_is_part_of_the_interval_and_known_apart(best: Candidate):
    plain = told(best, [best], NOTHING, NOTHING, box(best), ())
    found = told(best, [best], NOTHING, np.full(len(TOLD), 0.02), box(best), ())
    told_at_all = np.isfinite(plain.half)
    assert found.half[told_at_all] == pytest.approx(np.hypot(plain.half, 0.02)[told_at_all])
    assert found.apart_from_room[told_at_all] == pytest.approx(plain.half[told_at_all])


def test_damping_makes_up_for_what_the_model_lacks(best: Candidate):
    for cost, is_told in ((0.2, True), (EXPLAINED, False)):
        half = told(replace(best, cost=cost), [best], NOTHING, NOTHING, box(best), ("backlash",)).half
        assert np.isfinite(half[TOLD.index("damping")]) == is_told, cost


def test_friction_without_which_the_recording_is_predicted_as_well_is_not_told(
    best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    """Where a drive turns one way alone three times as much or a third may predict worse, and none as well."""
    coulomb, others = TOLD.index("coulomb"), [TOLD.index(name) for name in ("backlash", "damping")]
    assert np.isfinite(told(best, [best], NOTHING, NOTHING, box(best), ()).half[coulomb])
    monkeypatch.setattr(estimate, "alike", lambda one, _: one.values["coulomb"] == 0.0)
    half = told(best, [best], NOTHING, NOTHING, box(best), ()).half
    assert np.isinf(half[coulomb]) and np.all(np.isfinite(half[others]))


def test_a_gap_without_which_the_recording_is_explained_as_well_is_not_told(
    best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    place = TOLD.index("backlash")
    assert np.isfinite(told(best, [best], NOTHING, NOTHING, box(best), ()).half[place])
    monkeypatch.setattr(estimate, "without_gap", lambda one, _: one)
    monkeypatch.setattr(estimate, "gap_bound", lambda *_: None)
    found = told(best, [best], NOTHING, NOTHING, box(best), ())
    assert np.isinf(found.half[place]) and found.gap_bound is None


def test_where_no_gap_shows_motor_and_load_may_be_divided_elsewhere(
    best: Candidate, monkeypatch: pytest.MonkeyPatch
):
    plain = told(best, [best], NOTHING, NOTHING, box(best), ())
    apart = np.where(np.array(TOLD) == "backlash", 1.1 * APART, 0.0)
    shows = told(best, [best], apart, NOTHING, box(best), ())
    assert np.isinf(shows.half[TOLD.index("backlash")])
    assert shows.half[:3] == pytest.approx(plain.half[:3]), "its place shows, though its size does not"
    monkeypatch.setattr(estimate, "without_gap", lambda one, _: one)
    monkeypatch.setattr(estimate, "gap_bound", lambda *_: 0.1)
    none = told(best, [best], apart, NOTHING, box(best), ())
    assert none.half[:3] == pytest.approx(plain.half[:3]), "there is no gap to be elsewhere"
    monkeypatch.setattr(estimate, "gap_bound", lambda *_: None)
    elsewhere = told(best, [best], apart, NOTHING, box(best), ())
    room = room_for_division(best, APART)
    assert elsewhere.half[:3] == pytest.approx(np.hypot(plain.half, room)[:3])
    assert elsewhere.apart_from_room[:3] == pytest.approx(plain.half[:3])
    monkeypatch.setattr(estimate, "without_gap", lambda *_: None)
    monkeypatch.setattr(estimate, "_other_does_as_well", lambda _, name: name == "backlash")
    any_size = told(best, [best], apart, NOTHING, box(best), ())
    assert any_size.half[:3] == pytest.approx(elsewhere.half[:3]), (
        "a gap of any size does as well, but none does not"
    )
    monkeypatch.setattr(estimate, "room_for_division", lambda *_: np.full(len(TOLD), 1.1 * APART))
    lost = told(best, [best], apart, NOTHING, box(best), ())
    assert np.isinf(lost.half).all(), "motor and load may be divided anywhere"


@pytest.mark.parametrize(("cost", "widest"), [(0.2, APART), (EXPLAINED, np.inf), (-EXPLAINED, np.inf)])
def test_where_the_recording_is_not_explained_any_shaft_may_have_the_gap(
    best: Candidate, monkeypatch: pytest.MonkeyPatch, cost: float, widest: float
):
    seen: list[float] = []

    def room(_: Candidate, most: float) -> np.ndarray:
        seen.append(most)
        return NOTHING

    monkeypatch.setattr(estimate, "room_for_division", room)
    monkeypatch.setattr(estimate, "_other_does_as_well", lambda _, name: name == "backlash")
    monkeypatch.setattr(estimate, "without_gap", lambda *_: None)
    told(replace(best, cost=cost), [best], NOTHING, NOTHING, box(best), ())
    assert seen == [widest]

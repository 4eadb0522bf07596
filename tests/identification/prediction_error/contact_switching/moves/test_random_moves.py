"""Random moves lead from a wrong minimum to the right one, change only what they may, and are always the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD, distance
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.moves import random_moves
from lostmotion.identification.prediction_error.contact_switching.moves.random_moves import moved, wandering
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.starts.from_drivetrain import free_places
from lostmotion.identification.prediction_error.contact_switching.structures.no_gap import bare
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import (
    FOURTH,
    THIRD,
    has_fourth,
)


@pytest.fixture
def best(flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float]) -> Candidate:
    part = flt.liveliest(3000)
    theta = part.theta(values | {"impact": 1e-3})
    return Candidate("truth", theta, part.run(theta).cost, part, free_places(plant, ()))


@pytest.fixture
def box(best: Candidate) -> Box:
    return Box.around(best.flt, best.theta, 100.0)


@pytest.fixture
def free(plant: lm.Drivetrain) -> set[int]:
    return {*free_places(plant, ()), *THIRD}


@pytest.mark.parametrize("wrong", ["wide gap", "no gap"])
def test_the_truth_is_found_from_a_wrong_minimum(
    best: Candidate, box: Box, free: set[int], plant: lm.Drivetrain, wrong: str
):
    """No descent leads from 60 times the backlash to it, nor from none."""
    theta = best.flt.changed(best.theta, backlash=60.0 * plant.backlash)
    begun = replace(best, theta=theta) if wrong == "wide gap" else bare(best)
    stuck = polish(begun, best.flt, box)
    assert not distance(stuck, best)[TOLD.index("backlash")] < 1.0
    found = wandering(stuck, best.flt, box, free)
    lowest = min(found, key=lambda one: one.cost)
    assert lowest.cost < stuck.cost - 0.05
    assert np.max(distance(lowest, best)[:5]) < 0.02
    assert all(one.cost == pytest.approx(one.flt.run(one.theta).cost, abs=1e-12) for one in found)


def test_it_ends_where_nothing_is_lower(best: Candidate, box: Box, free: set[int]):
    """And is the same each time: its moves are drawn from one seed."""
    at = polish(best, best.flt, box)
    found = wandering(at, best.flt, box, free, patience=1)
    assert len(found) == random_moves.FOLLOWED
    again = wandering(at, best.flt, box, free, patience=1)
    assert [one.cost for one in found] == [one.cost for one in again]


def test_moves_change_only_what_they_may_and_stay_in_the_box(best: Candidate, box: Box, free: set[int]):
    rates = {INDEX[name] for name in ("motor_rate", "load_rate", "impact")}
    held = {INDEX["inertia_load"], INDEX["backlash"], INDEX["coulomb_motor"]}
    few = replace(best, free=[place for place in best.free if place not in held])
    for seed in range(40):
        move = moved(few, np.random.default_rng(seed), box, free - held)
        assert held.isdisjoint(move.free)
        changed = set(np.flatnonzero(move.theta != best.theta))
        assert changed <= (free - held) | rates
        own = [place for place in move.free if np.isfinite(move.theta[place])]
        assert np.all((move.theta[own] >= box.lower[own]) & (move.theta[own] <= box.upper[own]))


def test_moves_reach_every_part(best: Candidate, box: Box, free: set[int]):
    """A gap where there was none, a third inertia on either side and none, other friction, other inertias."""
    moves = [moved(bare(best), np.random.default_rng(seed), box, free) for seed in range(60)]
    gaps = [one for one in moves if np.isfinite(one.theta[INDEX["backlash"]])]
    # A constant torque at the motor would hold the gap closed.
    assert gaps and all(one.theta[INDEX["torque_offset"]] == 0.0 for one in gaps)
    assert all({INDEX["backlash"], INDEX["torque_offset"]} <= set(one.free) for one in gaps)
    thirds = [one for one in moves if np.isfinite(one.theta[THIRD[0]])]
    assert {one.flt.behind for one in thirds} == {False, True}
    assert any(
        not np.isfinite(moved(thirds[0], np.random.default_rng(s), box, free).theta[THIRD[0]])
        for s in range(40)
    )
    for place in (INDEX["inertia_motor"], INDEX["coulomb"], INDEX["coulomb_motor"]):
        assert len({float(one.theta[place]) for one in moves}) > 10


def test_a_third_inertia_gets_a_fourth_which_may_move_and_go(best: Candidate, box: Box, free: set[int]):
    """Where there is no third, there is no fourth; the third may go only with it."""
    free = free | {*FOURTH}
    rngs = [np.random.default_rng(seed) for seed in range(120)]
    thirds = [
        one for one in (moved(best, rng, box, free) for rng in rngs) if np.isfinite(one.theta[THIRD[0]])
    ]
    assert thirds and not any(has_fourth(one) for one in thirds)
    fourths = [one for one in (moved(thirds[0], rng, box, free) for rng in rngs) if has_fourth(one)]
    assert {one.flt.fourth_behind for one in fourths} == {False, True}
    assert all({*THIRD, *FOURTH} <= {*one.free} for one in fourths)
    again = [moved(fourths[0], rng, box, free) for rng in rngs]
    left = {(bool(np.isfinite(one.theta[THIRD[0]])), has_fourth(one)) for one in again}
    assert left == {(True, True), (True, False), (False, False)}
    assert not any(has_fourth(moved(thirds[0], rng, box, free - {*FOURTH})) for rng in rngs)


def test_the_total_inertia_and_the_gap_over_the_wind_up_stay_where_inertias_move(
    best: Candidate, box: Box, free: set[int]
):
    rng = np.random.default_rng(3)
    before, after = (one.flt.values(one.theta) for one in (best, random_moves._inertias(best, rng, free)))
    totals, windups = (
        [v[INDEX["inertia_motor"]] + v[INDEX["inertia_load"]] for v in (before, after)],
        [v[INDEX["backlash"]] * v[INDEX["stiffness"]] for v in (before, after)],
    )
    assert totals[0] == pytest.approx(totals[1]) and windups[0] == pytest.approx(windups[1])
    assert after[INDEX["inertia_motor"]] != pytest.approx(before[INDEX["inertia_motor"]], rel=1e-3)


def test_moves_of_friction_make_it_coulombs_or_leave_the_kinds_as_they_are(
    best: Candidate, box: Box, free: set[int]
):
    """A minimum with the friction viscous instead of Coulomb's is left by no descent."""
    speed = best.flt.speed_deviation
    viscous = replace(best, theta=best.flt.changed(best.theta, coulomb=0.0, viscous=2.0 / speed))
    moves = [random_moves._friction(viscous, np.random.default_rng(seed), free).values for seed in range(60)]
    dry = np.array([one["coulomb"] + one["coulomb_motor"] for one in moves])
    wet = speed * np.array([one["viscous"] + one["viscous_motor"] for one in moves])
    share = dry / (dry + wet)
    assert np.sum(share < 1e-6) > 10 and np.sum(share > 1.0 - 1e-6) > 10
    assert np.sum((share > 0.1) & (share < 0.9)) > 5
    assert 0.5 < np.median(dry + wet) < 8.0
    both = replace(best, theta=best.flt.changed(best.theta, coulomb=1.0, viscous=1.0 / speed))
    kept = [random_moves._friction(both, np.random.default_rng(seed), free).values for seed in range(60)]
    ratio = [
        (v["coulomb"] + v["coulomb_motor"]) / (speed * (v["viscous"] + v["viscous_motor"]) + 1e-9)
        for v in kept
    ]
    assert np.sum(np.abs(np.array(ratio) - 1.0) < 1e-6) > 10

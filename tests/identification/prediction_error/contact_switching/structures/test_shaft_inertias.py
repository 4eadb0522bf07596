"""A third inertia and a fourth: a descent finds each on its side of the gap, with a loss factor of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import (
    FOURTH,
    LAST,
    PLACES,
    THIRD,
    Place,
    has_fourth,
    places,
    with_dropped,
    with_further_inertias,
    without_last_inertia,
)

FREE = ("inertia_motor", "inertia_load", "stiffness", "damping", "backlash", "coulomb")


@pytest.mark.parametrize("behind", [False, True], ids=["before the gap", "behind it"])
def test_a_descent_finds_it_on_its_side(
    recorded: Callable[..., ContactFilter], two_masses: dict[str, float], behind: bool
):
    flt = recorded(behind)
    theta = flt.theta(two_masses)
    free, box = sorted(INDEX[name] for name in FREE), Box.around(flt, theta, 30.0)
    two = polish(Candidate("two masses", theta, flt.run(theta).cost, flt, free), flt, box)
    found = polish(
        with_further_inertias([(two, Place(0.1, 0.3, behind=behind))], flt, box)[0],
        replace(flt, behind=behind),
        box,
    )
    assert found.cost < 0.2 < 0.4 < two.cost
    place = Place.of(found)
    assert place is not None and place.behind is behind and Place.of(two) is None
    assert place.share == pytest.approx(0.1, rel=0.05)
    assert place.compliance == pytest.approx(4000.0 / 13000.0, rel=0.05)
    assert found.start == "two masses"


@pytest.mark.parametrize("fourth_behind", [False, True], ids=["before the gap", "behind it"])
def test_a_descent_finds_a_fourth_beside_a_third(
    four_inertias: Callable[[bool, bool], tuple[ContactFilter, dict[str, float]]], fourth_behind: bool
):
    flt, values = four_inertias(False, fourth_behind)
    theta = flt.theta(values | {"motor_rate": 30.0, "load_rate": 10.0})
    free, box = sorted({*(INDEX[name] for name in FREE), *THIRD}), Box.around(flt, theta, 30.0)
    true = Candidate("three masses", theta, np.inf, flt, [*free, *FOURTH])
    three = without_last_inertia(true, box)
    assert Place.of(three) is not None and not has_fourth(three) and not three.flt.fourth_behind
    begun = places(three, flt, [fourth_behind], fourth=True)
    assert all(place.fourth and place.behind is fourth_behind for place in begun)
    four = with_further_inertias([(three, place) for place in begun], flt, box)[0]
    assert has_fourth(four) and four.flt.fourth_behind is fourth_behind and four.contains(three)
    four = polish(four, four.flt, box)
    assert four.cost < 0.2 < three.cost - 0.2
    for name in ("inertia_motor", "inertia_load", "stiffness", "backlash"):
        assert four.values[name] == pytest.approx(values[name], rel=0.02)
    none = with_dropped(four)
    assert (
        Place.of(none) is None and not has_fourth(none) and none.free == sorted(INDEX[name] for name in FREE)
    )


def test_the_better_half_of_the_descents_goes_on_to_each_noise_level():
    flt, two, box = hub()
    pairs = [(two, place) for place in places(two, flt)] * 6
    rows = replace(flt, floor=0.01 * flt.floor)
    found = with_further_inertias(pairs, rows, box)
    assert LAST <= len(found) < len(pairs) // 2
    assert [one.cost for one in found] == sorted(one.cost for one in found)
    assert all(one.flt.level == rows.floor for one in found)
    assert with_further_inertias([], rows, box) == []


def hub() -> tuple[ContactFilter, Candidate, Box]:
    """A motor with a heavy hub on a stiff shaft, and what two masses make of it: three rows in a period of the second
    mode."""
    dt, shafts = 3e-3, [lm.Shaft(4.4, 6e-4), lm.Shaft(0.15, 1.6e-5)]
    inertias = [3.6e-5, 1.5e-5, 13.3e-5]
    rng = np.random.default_rng(1)
    torque = 0.012 * np.repeat(rng.choice([-1.0, 1.0], 500), 4)
    speed = lm.simulate(lm.Drivetrain(inertias, shafts), torque_motor=torque, dt=dt)["speed_motor"]
    flt = ContactFilter(
        torque, speed + 0.3 * rng.standard_normal(speed.size), dt, False, 0.3, 0.3, 6, (0, speed.size)
    )
    two = {"inertia_motor": 5.1e-5, "inertia_load": 13.3e-5, "stiffness": 0.145, "damping": 1.6e-5}
    theta = flt.theta(two | {"motor_rate": 1.0, "load_rate": 1.0})
    free, box = [INDEX[name] for name in two], Box.around(flt, theta, 30.0)
    return flt, polish(Candidate("two masses", theta, np.inf, flt, free), flt, box), box


def test_descents_start_where_the_candidate_predicts_best():
    """From the usual places alone no descent finds a heavy hub on a stiff shaft (a motor inertia 2 % off, ±0.7)."""
    flt, two, box = hub()
    starts = places(two, flt)
    assert len(set(starts)) == len(starts) and {one.behind for one in starts} == {False, True}
    assert starts == [*places(two, flt, [False]), *places(two, flt, [True])]
    further = [one for one in starts if (one.share, one.compliance) not in PLACES]
    usual = [one for one in starts if one not in further]

    def lowest(begun: list[Place]) -> float:
        return with_further_inertias([(two, place) for place in begun], flt, box)[0].cost

    assert lowest(further) < 0.05 < 0.15 < min(two.cost, lowest(usual))

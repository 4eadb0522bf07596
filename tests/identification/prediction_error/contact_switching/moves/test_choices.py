"""What a candidate may be otherwise: nothing that is fixed, and no part that it has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import LAWS, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import (
    Box,
    Candidate,
    cost_of,
    polish,
)
from lostmotion.identification.prediction_error.contact_switching.moves.choices import (
    SPLITS,
    is_late,
    other_choices,
    other_parts,
    with_split,
)
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX, NAMES
from lostmotion.identification.prediction_error.contact_switching.structures.no_gap import bare
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import (
    Place,
    has_fourth,
)
from lostmotion.identification.prediction_error.innovations import Predictor

DT = 2e-4
CORE = ("inertia_motor", "inertia_load", "stiffness", "damping")


@pytest.fixture
def box(flt: ContactFilter, values: dict[str, float]) -> Box:
    return Box.around(flt, flt.theta(values), 30.0)


def candidate(flt: ContactFilter, values: dict[str, float], *free: str) -> Candidate:
    theta = flt.theta(values)
    return Candidate("truth", theta, flt.run(theta).cost, flt, sorted(INDEX[name] for name in (*CORE, *free)))


def test_what_is_fixed_is_no_choice(flt: ContactFilter, values: dict[str, float], box: Box):
    """Torque, load torque and a gap's law can always be otherwise; gap and rise if they are free."""
    always = 2 + len(LAWS) - 1
    assert len(other_choices(bare(candidate(flt, values)), box)) == 2
    assert len(other_choices(candidate(flt, values), box)) == always
    assert len(other_choices(candidate(flt, values, "backlash"), box)) == always + 1
    assert len(other_choices(candidate(flt, values, "coulomb"), box)) == always + 2
    assert len(other_choices(candidate(flt, values, "coulomb", "rise", "fade"), box)) == always


def test_a_part_that_it_lacks_is_added(flt: ContactFilter, values: dict[str, float], box: Box):
    few = flt.part(slice(0, 1000))
    best = candidate(flt, values, "backlash")
    both = [part(best) for part in other_parts(best, few, box, None)]
    assert [one.flt.behind for one in both] == [False, True]
    for one in both:
        assert one.start == "further inertia" and one.flt.rows == 1000 and Place.of(one) is not None
    # One that has a third inertia gets it on the other side, or a fourth on either.
    others = [part(both[1]) for part in other_parts(both[1], few, box, None)]
    sides = [(one.flt.behind, one.flt.fourth_behind, has_fourth(one)) for one in others]
    assert sides == [(False, False, False), (True, False, True), (True, True, True)]
    assert all(Place.of(one) is not None for one in others)
    # One with a fourth gets no more.
    assert other_parts(others[1], few, box, None) == []


def test_a_rise_keeps_the_noise_level(flt: ContactFilter, values: dict[str, float], box: Box):
    """At the floor it would predict worse than the best for the level alone."""
    best = candidate(flt, values, "coulomb")
    best = replace(best, flt=replace(flt, level=5.0 * flt.floor))
    *_, rising = [part(best) for part in other_parts(best, flt.part(slice(0, 1000)), box, (0.1, 0.3))]
    assert rising.start == "rising friction" and rising.rises
    assert rising.flt.level == pytest.approx(5.0 * flt.floor) and np.isfinite(rising.cost)


def test_a_late_torque_has_other_splits_of_lag_and_delay(
    flt: ContactFilter, values: dict[str, float], box: Box
):
    late = values | {"lag": 0.004, "delay": 0.002}
    own = candidate(flt, values, "lag", "delay")
    free = [INDEX["lag"], INDEX["delay"]]
    assert not is_late(own)  # 0.3 ms of a period of 10 ms
    assert not is_late(candidate(flt, late, "lag"))  # a delay that is fixed
    one = candidate(flt, late, "lag", "delay")
    assert is_late(one)
    assert len(other_choices(one, box)) == len(other_choices(own, box)) + len(SPLITS)
    for part in SPLITS:
        other = with_split(one, part)
        assert other.values["lag"] == pytest.approx(part * 0.006)
        assert other.values["lag"] + other.values["delay"] == pytest.approx(0.006)
        assert np.array_equal(np.delete(other.theta, free), np.delete(one.theta, free))


@pytest.fixture(scope="module")
def late(plant: lm.Drivetrain) -> tuple[ContactFilter, dict[str, float]]:
    """A drive whose torque acts 0.8 torsional periods late, 2 ms of a lag and 6 ms of a delay; and its values."""
    delay, drive = 30, plant.with_parameters(lag=0.002)
    torque = lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(drive, torque_motor=np.concatenate([np.zeros(delay), torque[:-delay]]), dt=DT)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(torque.size)
    flt = ContactFilter.of(Predictor(torque, speed, DT, False, drive, skip=0), 300.0)
    true = {name: value for name, value in drive.parameters().items() if name in NAMES}
    return flt, true | {"delay": delay * DT, "motor_rate": 3.0, "load_rate": 1.0}


def test_from_a_wrong_split_only_another_one_leads_to_the_drive(
    late: tuple[ContactFilter, dict[str, float]],
):
    """All else is right, and half of it each, as every start has it."""
    flt, values = late
    true = candidate(flt, values, "backlash", "coulomb", "viscous", "lag", "delay")
    box = Box.around(flt, true.theta, 30.0)
    wrong = polish(with_split(true, 0.5), flt, box)
    best = min((polish(with_split(wrong, part), flt, box) for part in SPLITS), key=cost_of)
    assert wrong.cost > true.cost + 0.2
    assert best.cost < true.cost + 0.01
    assert best.values["lag"] == pytest.approx(0.002, rel=0.02)

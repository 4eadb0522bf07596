"""What a candidate may be otherwise: nothing that is fixed, and no part that it has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import LAWS, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate
from lostmotion.identification.prediction_error.contact_switching.moves.choices import (
    other_choices,
    other_parts,
)
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.structures.no_gap import bare
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import Place

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
    # One that has a third inertia gets it on the other side.
    (other,) = other_parts(both[1], few, box, None)
    moved = other(both[1])
    assert not moved.flt.behind and Place.of(moved) is not None


def test_a_rise_keeps_the_noise_level(flt: ContactFilter, values: dict[str, float], box: Box):
    """At the floor it would predict worse than the best for the level alone."""
    best = candidate(flt, values, "coulomb")
    best = replace(best, flt=replace(flt, level=5.0 * flt.floor))
    *_, rising = [part(best) for part in other_parts(best, flt.part(slice(0, 1000)), box, (0.1, 0.3))]
    assert rising.start == "rising friction" and rising.rises
    assert rising.flt.level == pytest.approx(5.0 * flt.floor) and np.isfinite(rising.cost)

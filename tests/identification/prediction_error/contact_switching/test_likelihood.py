"""Descents with the contact-switching filter."""

from __future__ import annotations

import numpy as np

from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import (
    Box,
    descend,
    inverse_hessian,
    minimise,
    polish,
)

CORE = [INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]


def test_sensitivities_lead_back_to_the_truth(flt: ContactFilter, values: dict[str, float]):
    truth = flt.theta(values)
    theta = truth.copy()
    theta[CORE] += (0.05, -0.05, 0.05, -0.05)
    found, cost = minimise(flt, theta, CORE, Box.around(flt, truth, 10.0), 10)
    assert np.max(np.abs(found[CORE] - truth[CORE])) < 5e-3
    assert cost == flt.run(found).cost < flt.run(theta).cost


def test_what_began_outside_of_the_box_goes_on(flt: ContactFilter, values: dict[str, float]):
    """It was put to the box first, was worse there, and stayed: a refit that cannot move agrees with everything."""
    truth = flt.theta(values)
    box, place = Box.around(flt, truth, 10.0), INDEX["viscous"]
    theta = truth.copy()
    theta[CORE] += (0.05, -0.05, 0.05, -0.05)
    box.lower[place] = truth[place] + 3.0
    found, _ = minimise(flt, theta, sorted([*CORE, place]), box, 10)
    assert np.max(np.abs(found[CORE] - truth[CORE])) < 5e-3


def test_at_a_bound_the_others_go_on(flt: ContactFilter, values: dict[str, float]):
    """The stiffness may not come back: the others end where they would if it were not free."""
    truth = flt.theta(values)
    box, place = Box.around(flt, truth, 10.0), INDEX["stiffness"]
    box.lower[place] = truth[place] + 0.02
    theta = truth.copy()
    theta[CORE] += (0.05, -0.05, 0.02, -0.05)
    found, cost = minimise(flt, theta, CORE, box, 10)
    others = [one for one in CORE if one != place]
    expected, least = minimise(flt, theta, others, box, 20)
    assert found[place] == box.lower[place]
    assert cost < least + 0.01 and np.max(np.abs(found[CORE] - expected[CORE])) < 3e-3


def test_a_direction_without_information_leaves_the_others_alone():
    """An asymmetry where there is no friction, say."""
    jacobian = np.random.default_rng(1).standard_normal((3, 100))
    jacobian[1] = 0.0
    inverse = inverse_hessian(jacobian)
    known = np.ix_([0, 2], [0, 2])
    assert np.all(np.isfinite(inverse)) and inverse[1, 1] > 1e20
    assert np.allclose(inverse[known], np.linalg.inv(jacobian[[0, 2]] @ jacobian[[0, 2]].T), rtol=1e-6)


def test_a_descent_finds_the_truth_from_far_off(flt: ContactFilter, values: dict[str, float]):
    """From twice the stiffness and half the gap, by ever lower noise levels; the rest is polished, as in use."""
    truth = flt.theta(values)
    theta = truth.copy()
    theta[CORE] += np.log([1.3, 0.8, 2.0, 0.5])
    box = Box.around(flt, truth, 10.0)
    found = polish(descend("far", flt, theta, CORE, box), flt, box)
    assert np.max(np.abs(found.theta[CORE] - truth[CORE])) < 0.01
    assert found.cost < 0.06

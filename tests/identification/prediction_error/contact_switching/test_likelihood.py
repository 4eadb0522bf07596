"""Descents with the contact-switching filter."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.fitted import intervals
from lostmotion.identification.prediction_error.contact_switching.likelihood import (
    Box,
    descend,
    inverse_hessian,
    minimise,
    polish,
)
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import FRICTIONS, INDEX
from lostmotion.identification.prediction_error.innovations import NAMES, to_theta

CORE = [INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]


def test_sensitivities_lead_back_to_the_truth(flt: ContactFilter, values: dict[str, float]):
    truth = flt.theta(values)
    theta = truth.copy()
    theta[CORE] += (0.05, -0.05, 0.05, -0.05)
    found, cost = minimise(flt, theta, CORE, Box.around(flt, truth, 10.0), 10)
    assert np.max(np.abs(found[CORE] - truth[CORE])) < 5e-3
    assert cost == flt.run(found).cost < flt.run(theta).cost


def test_friction_goes_from_one_end_to_the_other(flt: ContactFilter, values: dict[str, float]):
    """A third of it started at the motor, where none is. Along logarithms the sum was lost on the way to none."""
    third = {f"{name}_motor": values[name] / 3.0 for name in ("coulomb", "viscous")}
    rest = {name: 2.0 / 3.0 * values[name] for name in ("coulomb", "viscous")}
    free, box = [INDEX[name] for name in FRICTIONS], Box.around(flt, flt.theta(values), 10.0)
    found, cost = minimise(flt, flt.theta(values | third | rest), free, box, 8)
    assert cost < flt.run(flt.theta(values)).cost + 1e-3
    coulomb, viscous, coulomb_motor, viscous_motor = flt.values(found)[free]
    assert coulomb_motor < 0.02 * coulomb and viscous_motor < 0.1 * viscous
    assert coulomb + coulomb_motor == pytest.approx(values["coulomb"], rel=0.01)


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
    found, cost = minimise(flt, theta, CORE, box, 20)
    others = [one for one in CORE if one != place]
    expected, least = minimise(flt, theta, others, box, 20)
    assert found[place] == box.lower[place]
    assert cost < least + 0.01 and np.max(np.abs(found[CORE] - expected[CORE])) < 3e-3


def test_friction_is_bounded_by_the_torque_whatever_its_unit(flt: ContactFilter, values: dict[str, float]):
    """A slow motion that tells no friction makes the unit small; the drive's friction may be large all the same."""
    torque, coulomb, viscous = flt.units
    small = replace(flt, units=(torque, 1e-3 * coulomb, 1e-3 * viscous))
    most = [one.values(Box.around(one, one.theta(values), 10.0).upper) for one in (flt, small)]
    places = [INDEX[name] for name in FRICTIONS]
    assert most[0][places] == pytest.approx(most[1][places])
    assert np.all(most[0][places] > 0.9 * np.array([torque, viscous, torque, viscous]))


def test_a_direction_without_information_leaves_the_others_alone():
    """A speed over which a friction fades that does not rise, say."""
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


def test_the_box_is_no_wider_than_the_intervals(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float]
):
    """10 % either way of what is identified; a friction enters θ plainly, and its interval is one of its logarithm."""
    theta = to_theta([getattr(plant, name) for name in NAMES], flt.dt)
    free = [NAMES.index(name) for name in ("stiffness", "coulomb", "viscous", "lag")]
    stage: Any = SimpleNamespace(free=free)
    told: Any = SimpleNamespace(theta=theta, half=np.full(len(free), 0.1))
    wide = Box.around(flt, flt.theta(values), 10.0)
    box = intervals(flt, stage, told, wide)
    for name in ("stiffness", "coulomb", "viscous"):
        low, high = (flt.values(end)[INDEX[name]] for end in (box.lower, box.upper))
        assert (low, high) == pytest.approx(
            (getattr(plant, name) * np.exp(-0.1), getattr(plant, name) * np.exp(0.1))
        )
    others = [INDEX[name] for name in ("inertia_motor", "backlash", "coulomb_motor")]
    assert np.array_equal(box.lower[others], wide.lower[others])
    assert np.array_equal(box.upper[others], wide.upper[others])

"""Gauss–Newton steps within bounds, and the secant steps between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching import gauss_newton
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.gauss_newton import (
    Bounds,
    Linear,
    minimise_within,
    step_within,
)

CORE = [INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]


def test_what_stops_at_a_bound_is_known_to_the_others():
    """Two values of which the sum is known well: cut off afterwards, the second left the first 0.9 away."""
    hessian, gradient = np.array([[1.0, 0.999], [0.999, 1.0]]), np.array([1.0, 1.0015])
    free = np.array([True, True])
    step = step_within(hessian, gradient, free, (np.full(2, -10.0), np.full(2, 10.0)), 10.0)
    assert step == pytest.approx(np.linalg.solve(hessian, -gradient))
    room = np.array([-10.0, -0.5]), np.full(2, 10.0)
    assert step[1] < -0.5
    step = step_within(hessian, gradient, free, room, 10.0)
    assert step == pytest.approx([-1.0 + 0.999 * 0.5, -0.5])
    held = step_within(hessian, gradient, np.array([True, False]), room, 10.0)
    assert held == pytest.approx([-1.0, 0.0])


def test_corrected_sensitivities_explain_the_step_and_nothing_across_it():
    rng = np.random.default_rng(1)
    true, wrong = rng.standard_normal((2, 3, 50))
    bounds = Bounds([0, 2, 3], np.full(3, -9.0), np.full(3, 9.0))
    theta, step = np.zeros(5), np.array([0.3, 0.0, -0.1, 0.2, 0.0])
    own = step[bounds.free]
    after = Linear(theta, np.ones(50), wrong).corrected(bounds, theta + step, 1.0 + own @ true)
    assert own @ after.jacobian == pytest.approx(own @ true)
    across = np.array([0.1, 0.3, 0.0])
    assert across @ own == pytest.approx(0.0)
    assert across @ after.jacobian == pytest.approx(across @ wrong)


def test_secant_steps_lead_further_without_sensitivities(
    flt: ContactFilter, values: dict[str, float], monkeypatch: pytest.MonkeyPatch
):
    """From 5 % off, a step with sensitivities and those after it end far below the one alone; counts of 18 bit
    make the valley so narrow that none is lower."""
    truth = flt.theta(values)
    theta = truth.copy()
    theta[CORE] += (0.05, -0.05, 0.05, -0.05)
    bounds = Bounds(CORE, truth[CORE] - 1.0, truth[CORE] + 1.0)
    least = minimise_within(flt, truth, bounds, 10)[1]
    found, cost = minimise_within(flt, theta, bounds, 1)
    assert cost == flt.run(found).cost
    monkeypatch.setattr(gauss_newton, "SECANTS", 0)
    alone = minimise_within(flt, theta, bounds, 1)[1]
    assert cost - least <= (1.0 if flt.counted else 0.5) * (alone - least)


def test_innovations_are_compared_over_the_same_deviations(flt: ContactFilter, values: dict[str, float]):
    """A step that makes the filter less sure must not look like one that makes it right."""
    run = flt.run(flt.theta(values))
    unsure = replace(run, weighted=0.5 * run.weighted, deviations=2.0 * run.deviations)
    assert gauss_newton._weighted_alike(unsure, run) == pytest.approx(run.weighted)
    assert gauss_newton._weighted_alike(replace(run, weighted=run.weighted[1:]), run) is None

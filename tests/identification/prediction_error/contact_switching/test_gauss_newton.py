"""Gauss–Newton steps within bounds."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.gauss_newton import step_within


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

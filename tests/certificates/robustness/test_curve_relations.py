"""Forms that hold for every pair of a curve's argument and value."""

from __future__ import annotations

import numpy as np

from lostmotion.certificates.robustness.curve_relations import CurveShape, Reading, _of_copies


def readings() -> list[Reading]:
    """Two curves over the vector (argument, argument, value, value)."""
    row = np.eye(4)
    return [Reading(0, row[0], row[2]), Reading(1, row[1], row[3])]


def jump(argument: np.ndarray, down: float, up: float) -> np.ndarray:
    return np.where(argument > 0.0, up, -down)


def test_two_arguments_of_one_rising_curve_rise_together():
    (form,) = _of_copies(readings(), [CurveShape(2.0, 2.0, None)] * 2)
    arguments = np.random.default_rng(1).standard_normal((2, 200))
    vectors = np.concatenate([arguments, jump(arguments, 2.0, 2.0)])
    assert np.min(np.einsum("ik,ij,jk->k", vectors, np.asarray(form, dtype=float), vectors)) > -1e-12


def test_a_jump_that_is_not_odd_may_be_turned_round_and_is_no_copy():
    """Backwards 1 and forwards 2 at the motor, the other way round at the load: one shape, but two curves."""
    assert _of_copies(readings(), [CurveShape(1.0, 2.0, None)] * 2) == []
    # The second argument is the larger one, its value is not.
    assert jump(np.array(0.2), 1.0, 2.0) > jump(np.array(0.5), 2.0, 1.0)

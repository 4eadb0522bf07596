"""Sums of columns in flat arrays against numpy."""

from __future__ import annotations

from importlib import import_module

import numpy as np
import pytest
from numba import njit
from numba.core.dispatcher import Dispatcher

from lostmotion.kernels.innovations.columns import add, combine, copy, product_of, turned_product
from lostmotion.kernels.innovations.transitions import WIDE
from lostmotion.kernels.jit import BORROWED

N = WIDE
RANDOM = np.random.default_rng(4)


def columns(count: int) -> np.ndarray:
    """So many random columns of a matrix, flat."""
    return RANDOM.standard_normal(count * WIDE)


def matrix(flat: np.ndarray) -> np.ndarray:
    return flat.reshape(-1, WIDE).T


@njit
def _all(f, b, noise, product, covariance, column, copied):
    product_of(f, 0, N, b, N, product)
    turned_product(product, f, 0, N, noise, 1, covariance)
    combine(f, 0, N, b, WIDE, 1, column, 0, column, 0)
    add(f, 2 * WIDE, -0.5, column, 0)
    copy(column, copied)


def test_products_and_sums():
    f, half, noise = columns(WIDE), columns(WIDE), columns(2 * WIDE)
    symmetric = (matrix(half) @ matrix(half).T).T.reshape(-1).copy()
    own = matrix(noise[WIDE * WIDE :])
    noise[WIDE * WIDE :] = (own @ own.T).T.reshape(-1)
    product, covariance = np.zeros(WIDE * WIDE), np.zeros(WIDE * WIDE)
    first = RANDOM.standard_normal(WIDE)
    column, copied = first.copy(), np.zeros(WIDE)
    _all(f, symmetric, noise, product, covariance, column, copied)
    F, P, Q = matrix(f), matrix(symmetric), matrix(noise[WIDE * WIDE :])
    np.testing.assert_allclose(matrix(product), F @ P, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(matrix(covariance), F @ P @ F.T + Q, rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(matrix(covariance), matrix(covariance).T)
    np.testing.assert_allclose(column, first + F @ P[:, 1] - 0.5 * F[:, 2], rtol=1e-12, atol=1e-12)
    np.testing.assert_array_equal(copied, column)


@pytest.mark.parametrize(
    "module",
    [
        "changes",
        "columns",
        "delayed_torque",
        "gap_in_doubt",
        "motion",
        "sample_parts",
        "sensitivities",
        "sliding_friction",
    ],
)
def test_what_runs_in_every_row_counts_no_references(module: str):
    """Counted, the arrays of the contact-switching filter's inner calls took half of its time."""
    names = vars(import_module(f"lostmotion.kernels.innovations.{module}"))
    kernels = [one for one in names.values() if isinstance(one, Dispatcher)]
    if not BORROWED:
        pytest.skip("this numba has no option _nrt: kernels are slower by the counting, not wrong")
    assert kernels and all(one.targetoptions.get("_nrt") is False for one in kernels)

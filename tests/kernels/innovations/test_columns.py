"""Sums of columns in flat arrays against numpy."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.innovations.columns import add, combine, copy, product_of, turned_product
from lostmotion.kernels.innovations.transitions import WIDE

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

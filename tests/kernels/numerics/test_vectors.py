"""Four floats in a register against numpy, on the address of an array."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.numerics.vectors import (
    absolute,
    add,
    address,
    fused,
    larger,
    less,
    load,
    multiply,
    pack,
    read,
    read_integer,
    smaller,
    splat,
    spread,
    store,
    subtract,
    total,
    write,
    write_integer,
)

A = np.array([1.5, -2.0, 0.25, 7.0, -0.5, 3.0])
B = np.array([-1.0, 4.0, 0.25, -7.0, 2.0, 9.0])


@njit
def _all(a, b, out):
    first, second, to = address(a), address(b), address(out)
    x, y = load(first, 1), load(second, 2)
    store(to, 0, add(x, y))
    store(to, 4, subtract(x, y))
    store(to, 8, multiply(x, y))
    store(to, 12, absolute(x))
    store(to, 16, smaller(x, y))
    store(to, 20, larger(x, y))
    store(to, 24, fused(x, y, splat(read(second, 0))))
    store(to, 28, spread(x, 2))
    store(to, 32, pack(read(first, 4), read(first, 1), 5.0, total(y)))
    write(to, 36, read(first, 5))


def test_every_operation():
    out = np.zeros(38)
    _all(A, B, out)
    x, y = A[1:5], B[2:6]
    expected = [x + y, x - y, x * y, np.abs(x), np.minimum(x, y), np.maximum(x, y), x * y - 1.0]
    expected += [np.full(4, x[2]), [x[3], x[0], 5.0, y.sum()], [A[5], 0.0]]
    np.testing.assert_array_equal(out, np.concatenate(expected))


@njit
def _less(a, b):
    return less(load(address(a), 0), load(address(b), 0))


def test_bits_of_a_comparison():
    a = np.array([0.0, 1.0, np.nan, -np.inf])
    assert _less(a, np.array([1.0, 1.0, 1.0, 1.0])) == 0b1001
    assert _less(np.zeros(4), a) == 0b0010


@njit
def _swap(numbers):
    at = address(numbers)
    first = read_integer(at, 0)
    write_integer(at, 0, read_integer(at, 1))
    write_integer(at, 1, first)


def test_integers():
    numbers = np.array([-3, 2**40])
    _swap(numbers)
    assert numbers.tolist() == [2**40, -3]

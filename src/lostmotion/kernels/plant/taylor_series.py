"""Taylor series of a mode: its terms over a sub-step, their sum, and by doubling the whole sample; see ``modes``."""

from __future__ import annotations

from typing import Any

from ..jit import njit
from ..numerics.vectors import LANES, absolute, add, fused, load, read, splat, store, total, write
from .equations import ELEMENT_OF_FRICTION, REST, driving_torque
from .layout import padded

#: The Taylor series ends where its terms fall below this part of what a torque moves in a sub-step (rounding of that).
#: (Numerics.)
LAST_TERM = 1e-16
#: Highest order of the Taylor series, which the largest sub-step needs (numerics: ``contact_states.PIECE_NORM``).
ORDER = 15
#: Times this, a number splits in two halves of 26 bits (numerics: Dekker 1971).
SPLIT = 2.0**27 + 1.0

_INNER: Any = {
    "cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True, "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # fmt: skip
#: Where every rounding counts: nothing is contracted.
_EXACT: Any = {**_INNER, "fastmath": False}


@njit(**_INNER)
def needed_order(size):
    """How many Taylor terms a double-precision sum needs where ‖F‖·length is `size`.

    Measured by what a torque moves, its double integral, whose part of order n is 2·sizeⁿ⁻²/n! of it.
    """
    order = 3
    term = size * size / 12.0
    while term >= LAST_TERM and order < ORDER:
        order += 1
        term *= size / (order + 1)
    return order


@njit(inline="always", **_INNER)
def _left_product(matrix, states, high, at, to, factor, columns):
    """factor · matrix · (rows at `at`), written to `to`; all stand by columns of `high` numbers."""
    for j in range(columns):
        for i in range(0, high, LANES):
            value = splat(0.0)
            for m in range(states):
                value = fused(load(matrix, m * high + i), splat(factor * read(at, j * high + m)), value)
            store(to, j * high + i, value)


@njit(**_INNER)
def state_terms(rows, rate, matrix, at, length, order, states, high):
    """Taylor terms F (length·F)ⁿ⁻¹ length / n! of order 1 to `order`, rows of x, by columns from address `at` on."""
    columns = rows.shape[1]
    for j in range(columns):
        for i in range(high):
            value = rows[rate + i, j] if i < states else 0.0
            write(at, j * high + i, value * length)
            if j < states:
                write(matrix, j * high + i, value)
    for n in range(2, order + 1):
        later = at + 8 * columns * high
        _left_product(matrix, states, high, at, later, length / n, columns)
        at = later


@njit(**_INNER)
def guard_terms(rows, guard, row, terms, at, order, states, high, weights, second, fourth):
    """Taylor coefficients of the guards over a sub-step, and bounds of their second and fourth derivative on it."""
    columns, wide = rows.shape[1], padded(ORDER + 1)
    for e in range(rows.shape[0] - guard):
        for i in range(high):
            write(row, i, rows[guard + e, i] if i < states else 0.0)
        for j in range(columns):
            p = at + 8 * (e * columns + j) * wide
            write(p, 0, rows[guard + e, j])
            for n in range(1, order + 1):
                product = splat(0.0)
                term = terms + 8 * ((n - 1) * columns + j) * high
                for i in range(0, high, LANES):
                    product = fused(load(row, i), load(term, i), product)
                write(p, n, total(product))
            for n in range(order + 1, padded(order + 1)):
                write(p, n, 0.0)
            bound2, bound4 = splat(0.0), splat(0.0)
            for n in range(0, order + 1, LANES):
                size = absolute(load(p, n))
                bound2 = fused(load(weights, n), size, bound2)
                bound4 = fused(load(weights, wide + n), size, bound4)
            write(second, e * columns + j, total(bound2))
            write(fourth, e * columns + j, total(bound4))


@njit(**_EXACT)
def _difference_of_products(a, b, c, d):
    """a·b − c·d for nearly equal products, to twice the precision (Dekker 1971: halves of 26 bits)."""
    p, q = a * b, c * d
    a_high, b_high = a * SPLIT - (a * SPLIT - a), b * SPLIT - (b * SPLIT - b)
    c_high, d_high = c * SPLIT - (c * SPLIT - c), d * SPLIT - (d * SPLIT - d)
    a_low, b_low, c_low, d_low = a - a_high, b - b_high, c - c_high, d - d_high
    p_low = a_low * b_low - (((p - a_high * b_high) - a_low * b_high) - a_high * b_low)
    q_low = c_low * d_low - (((q - c_high * d_high) - c_low * d_high) - c_high * d_low)
    return (p - q) + (p_low - q_low)


@njit(**_INNER)
def first_term_rests(chain, p, digits, rows, low, terms, pieces, high):
    """What rounding took from the accelerations in the term of first order, by columns.

    A plant whose stiffness is wrong by a rounding runs out of phase by ω·t/2 of it: 3e-15 in a tenth of a second.
    """
    n, columns = chain.inertias.shape[0] - 1, rows.shape[1]
    for j in range(columns):
        for i in range(high):
            write(low, j * high + i, 0.0)
    for i in range(n):
        e = chain.inertias[i, ELEMENT_OF_FRICTION]
        if i == chain.locked or (e >= 0 and digits[e] == chain.elements[e, REST]):
            continue
        for j in range(columns):
            torque = driving_torque(rows, n, i, j) - rows[3 * n - 2 + i, j]
            if torque != 0.0:
                at = j * high + n - 1 + i
                rest = _difference_of_products(torque, p[0] / pieces, read(terms, at), p[2 + i])
                write(low, at, rest / p[2 + i])


@njit(**_INNER)
def whole_piece(delta, low, terms, order, numbers):
    """exp(F·length) − 1: the sum of the terms, the smallest first."""
    for j in range(0, numbers, LANES):
        value = load(terms, (order - 1) * numbers + j)
        for n in range(order - 2, 0, -1):
            value = add(value, load(terms, n * numbers + j))
        store(delta, j, add(add(value, load(low, j)), load(terms, j)))


@njit(**_INNER)
def double(delta, bounds, elements, states, high, columns):
    """From a time to twice the time: exp(F·time) − 1, and the bounds over it; scratch follows each."""
    count = 2 * elements * columns
    for e in range(0, count, columns):
        for j in range(columns):
            value = read(bounds, e + j) if j >= states else 0.0
            for i in range(states):
                value += read(bounds, e + i) * abs(read(delta, j * high + i) + (1.0 if i == j else 0.0))
            write(bounds, count + e + j, max(read(bounds, e + j), value))
    for j in range(count):
        write(bounds, j, read(bounds, count + j))
    numbers = columns * high
    _left_product(delta, states, high, delta, delta + 8 * numbers, 1.0, columns)
    for j in range(numbers):
        write(delta, j, 2.0 * read(delta, j) + read(delta, numbers + j))

"""Tables of one mode of a plant, straight from the drivetrain's numbers.

A mode is one combination of contact and friction states: the linear system ds/dt = F s with s = [x, v, 1] (see
``kernels.plant``). States x: n − 1 twists, n speeds, the motor angle, the angles of shafts that relax, the actuator's
torque. From F come, over a piece [0, L] of the sample time T = 2ʰ L, short against the fastest pole,

- the Taylor terms F (L F)ⁿ⁻¹ L / n!, from left products with dx/dx,
- exp(F T) − 1 as their sum, doubled h times: (1 + D)² − 1 = 2 D + D²,
- the Taylor coefficients cₙ of the guards, and from them the enclosure's bounds: |second derivative| ≤
  Σ n (n − 1) |cₙ| / L² on the piece, elementwise and likewise for the fourth, and over twice a time at most the larger
  of the bound and the bound · |exp(F·time)|.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from .mode_rows import (
    ANGLE,
    ELEMENT,
    ELEMENT_OF_FRICTION,
    GAP,
    LAW,
    LINEAR,
    REST,
    SHAFT_NUMBERS,
    Chain,
    driving_torque,
    fill_rows,
)
from .plant_tables import ELEMENT_ROWS, HEADER, Array, padded
from .vectors import LANES, absolute, add, address, fused, load, read, splat, store, total, write

#: Largest ‖F‖·(length of a piece) in the norm of energy (chosen: 15 terms reach the next number).
PIECE_NORM = 0.5
#: The Taylor series ends where its terms fall below this part of what a torque moves in a piece (rounding of that).
LAST_TERM = 1e-16
#: Highest order of the Taylor series, which the largest piece needs.
ORDER = 15
#: Times this, a number splits in two halves.
SPLIT = 2.0**27 + 1.0


class ModeWork(NamedTuple):
    """Rows of one mode over s, and scratch of `build_mode`; high: states in whole groups of LANES.

    The rows are, torques in Nm: n − 1 torques of the shafts; n − 1 of their springs, k·dz(twist) as this mode sees it;
    n torques from outside the chain; n frictions; dx/dt; E guards.
    """

    rows: Array  # (4 n − 2 + N + E, C)
    bounds: Array  # (E, 2): lower, upper
    weights: Array  # n (n − 1), then n (n − 1) (n − 2) (n − 3), for each order
    scratch: Array


def new_mode_work(chain: Chain) -> ModeWork:
    inertias, elements, states = len(chain.inertias) - 1, len(chain.elements), chain.states
    columns, high = states + len(chain.targets) + 1, -(-states // LANES) * LANES
    n = np.arange(-(-(ORDER + 1) // LANES) * LANES, dtype=float)
    second = n * (n - 1.0)
    return ModeWork(
        np.zeros((4 * inertias - 2 + states + elements, columns)),
        np.zeros((elements, 2)),
        np.concatenate([second, second * (n - 2.0) * (n - 3.0)]),
        np.zeros(2 * states + high + states * high + 2 * columns * high + 4 * elements * columns),
    )


_MODES: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True}
_INNER: Any = {**_MODES, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
#: Where every rounding counts: nothing is contracted.
_EXACT: Any = {**_INNER, "fastmath": False}


@njit(**_INNER)
def _norm(chain, p, digits, rows, scale):
    """A bound on the 2-norm of the part of dx/dx in which poles can arise, in coordinates of equal energy, 1/s.

    There a chain without losses is skew-symmetric. Left out is what nothing else depends on (the motor angle, twists
    in their gaps), and what depends on nothing else (a held end, an inertia at rest, the actuator beside its lag).
    """
    shafts, inertias, states = chain.shafts, chain.inertias, chain.states
    n = inertias.shape[0] - 1
    rate = 4 * n - 2
    scale[: 2 * states] = 0.0
    for i in range(n):
        e = inertias[i, ELEMENT_OF_FRICTION]
        if i != chain.locked and (e < 0 or digits[e] != chain.elements[e, REST]):
            scale[n - 1 + i] = np.sqrt(p[2 + i])
        if i < n - 1:
            root = np.sqrt(p[2 + n + SHAFT_NUMBERS * i])
            if shafts[i, ANGLE] >= 0:
                scale[shafts[i, ANGLE]] = root
            elif shafts[i, LAW] == LINEAR or digits[shafts[i, ELEMENT]] != GAP:
                scale[i] = root
    largest_row = 0.0
    largest_column = 0.0
    for i in range(states):
        if scale[i] == 0.0:
            continue
        row = 0.0
        for j in range(states):
            if rows[rate + i, j] != 0.0 and scale[j] != 0.0:
                size = abs(rows[rate + i, j]) * scale[i] / scale[j]
                row += size
                scale[states + j] += size
        largest_row = max(largest_row, row)
    for j in range(states):
        largest_column = max(largest_column, scale[states + j])
    norm = np.sqrt(largest_row * largest_column)
    return max(norm, 1.0 / p[1]) if chain.actuator >= 0 else norm


@njit(**_INNER)
def _needed_order(size):
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
def _state_terms(rows, rate, matrix, at, length, order, states, high):
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
def _guard_terms(rows, guard, row, terms, at, order, states, high, weights, second, fourth):
    """Taylor coefficients of the guards over a piece, and bounds of their second and fourth derivative on it."""
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
def _first_term_rests(chain, p, digits, rows, low, terms, pieces, high):
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
def _whole_piece(delta, low, terms, order, numbers):
    """exp(F·length) − 1: the sum of the terms, the smallest first."""
    for j in range(0, numbers, LANES):
        value = load(terms, (order - 1) * numbers + j)
        for n in range(order - 2, 0, -1):
            value = add(value, load(terms, n * numbers + j))
        store(delta, j, add(add(value, load(low, j)), load(terms, j)))


@njit(**_INNER)
def _double(delta, bounds, elements, states, high, columns):
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


@njit(**_INNER)
def _write_rows(rows, guard, bounds, delta, second, guards, at, pieces, high):
    """Change over the sample, guards, their rates and bounds, by columns; then where the guards must stay."""
    columns = rows.shape[1]
    elements = rows.shape[0] - guard
    wide = padded(elements)
    height = high + ELEMENT_ROWS * wide
    swing, remainder = 0.5 * pieces**2, pieces**4 / 384.0
    for j in range(columns):
        column = at + 8 * j * height
        for i in range(0, high, LANES):
            store(column, i, load(delta, j * high + i))
        for e in range(elements):
            number = e * columns + j
            write(column, high + e, rows[guard + e, j])
            write(column, high + wide + e, pieces * read(guards, number * padded(ORDER + 1) + 1))
            write(column, high + 2 * wide + e, swing * read(second, number))
            write(column, high + 3 * wide + e, remainder * read(second, elements * columns + number))
    for e in range(wide):
        write(at, columns * height + e, bounds[e, 0] if e < elements else -np.inf)
        write(at, columns * height + wide + e, bounds[e, 1] if e < elements else np.inf)


@njit(**_MODES)
def build_mode(chain, p, digits, flat, at, rows, bounds, weights, scratch):
    """Writes the block of the mode of these digits from flat[at] on; its series have the order that they need.

    rows, bounds, weights, scratch: of `ModeWork`; the rows are left filled.
    """
    states, columns = chain.states, rows.shape[1]
    elements = chain.elements.shape[0]
    guard = rows.shape[0] - elements
    fill_rows(chain, p, digits, rows, bounds)
    size = _norm(chain, p, digits, rows, scratch) * p[0]
    pieces = 1.0
    while size > PIECE_NORM:
        size *= 0.5
        pieces *= 2.0
    order = _needed_order(size)
    high, wide = padded(states), padded(elements)
    row = address(scratch) + 8 * 2 * states
    matrix = row + 8 * high
    delta = matrix + 8 * states * high
    second = delta + 8 * 2 * columns * high
    block = address(flat) + 8 * at
    header = columns * (high + ELEMENT_ROWS * wide) + 2 * wide
    terms = block + 8 * (header + HEADER)
    guards = terms + 8 * ORDER * columns * high
    _state_terms(rows, guard - states, matrix, terms, p[0] / pieces, order, states, high)
    _guard_terms(
        rows, guard, row, terms, guards, order, states, high, address(weights),
        second, second + 8 * elements * columns,
    )  # fmt: skip
    low = delta + 8 * columns * high  # where the doubling has its scratch
    _first_term_rests(chain, p, digits, rows, low, terms, pieces, high)
    _whole_piece(delta, low, terms, order, columns * high)
    length = 1.0
    while length < pieces:
        _double(delta, second, elements, states, high, columns)
        length *= 2.0
    _write_rows(rows, guard, bounds, delta, second, guards, block, pieces, high)
    write(block, header, 1.0 / pieces)
    write(block, header + 1, float(order))

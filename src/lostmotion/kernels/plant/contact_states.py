"""Tables of one mode of a plant, straight from the drivetrain's numbers.

A mode is one combination of contact and friction states: the linear system ds/dt = F s with s = [x, v, 1] (see
``kernels.plant.event_loop``). States x: n − 1 twists, n speeds, the motor angle, the angles of shafts that relax, the
actuator's torque. From F come, over a sub-step [0, L] of the sample time T = 2ʰ L, short against the fastest pole,

- the Taylor terms F (L F)ⁿ⁻¹ L / n!, from left products with dx/dx,
- exp(F T) − 1 as their sum, doubled h times: (1 + D)² − 1 = 2 D + D²,
- the Taylor coefficients cₙ of the guards, and from them the enclosure's bounds: |second derivative| ≤
  Σ n (n − 1) |cₙ| / L² on the sub-step, elementwise and likewise for the fourth, and over twice a time at most the
  larger of the bound and the bound · |exp(F·time)|.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..jit import njit
from ..numerics.vectors import LANES, address, load, read, store, write
from .equations import (
    ANGLE,
    ELEMENT,
    ELEMENT_OF_FRICTION,
    GAP,
    LAW,
    LINEAR,
    REST,
    SHAFT_NUMBERS,
    Chain,
    fill_rows,
)
from .layout import ELEMENT_ROWS, HEADER, Array, padded
from .taylor_series import (
    ORDER,
    double,
    first_term_rests,
    guard_terms,
    needed_order,
    state_terms,
    whole_piece,
)

#: Largest ‖F‖·(length of a sub-step) in the norm of energy (numerics: 15 terms reach the next number).
PIECE_NORM = 0.5


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
    order = needed_order(size)
    high, wide = padded(states), padded(elements)
    row = address(scratch) + 8 * 2 * states
    matrix = row + 8 * high
    delta = matrix + 8 * states * high
    second = delta + 8 * 2 * columns * high
    block = address(flat) + 8 * at
    header = columns * (high + ELEMENT_ROWS * wide) + 2 * wide
    terms = block + 8 * (header + HEADER)
    guards = terms + 8 * ORDER * columns * high
    state_terms(rows, guard - states, matrix, terms, p[0] / pieces, order, states, high)
    guard_terms(
        rows, guard, row, terms, guards, order, states, high, address(weights),
        second, second + 8 * elements * columns,
    )  # fmt: skip
    low = delta + 8 * columns * high  # where the doubling has its scratch
    first_term_rests(chain, p, digits, rows, low, terms, pieces, high)
    whole_piece(delta, low, terms, order, columns * high)
    length = 1.0
    while length < pieces:
        double(delta, second, elements, states, high, columns)
        length *= 2.0
    _write_rows(rows, guard, bounds, delta, second, guards, block, pieces, high)
    write(block, header, 1.0 / pieces)
    write(block, header + 1, float(order))

"""Tables of a piecewise-linear plant: its modes, one block of numbers each, and how kernels find their places.

The plant is a set of *modes*, each a linear system with constant inputs and a constant term. With
s = [x, v, 1] (N states, M held inputs, one; C numbers in all), a mode gives

- delta @ s        the change of x over one whole sample (exact),

and for each element e (a shaft with backlash, or a friction)

- guard @ s        its guard function, which must stay within [lower, upper] while the mode lasts,
- guard_rate @ s   T · d(guard)/dt,
- swing @ |s|      T²/2 · max |second derivative of guard| over the sample,
- remainder @ |s|  T⁴/384 · max |fourth derivative of guard|, the error of the cubic Hermite interpolation,

and the Taylor series of all guards and of the state over one *sub-step*, a time that is short against the mode's
fastest pole. ``flat`` holds one block of numbers per mode, which Plant in ``simulation.tables`` fills. Tables lie
column by column, since four rows at a time are a column's four numbers times one number of s; counts of rows are
rounded up to whole groups of four (N₄, E₄, (O + 1)₄), the rest being zero, and −∞, ∞ for bounds. O is the order of the
table that needs most:

    for each column of s    N₄ of delta, E₄ of guard, E₄ of guard_rate, E₄ of swing, E₄ of remainder
    E₄ lower bounds, E₄ upper bounds
    length of a sub-step in samples, order of this mode's own series, 0, 0
    for order 1 … O         for each column of s   N₄ of the state's coefficients
    for each element        for each column of s   (O + 1)₄ of the guard's coefficients, order 0 … O

Every element has one *digit*; its order is along the axis of its guard, so that leaving by the lower bound lowers the
digit by one and leaving by the upper bound raises it by one (shaft: −, gap, +; friction: negative segments, stick,
positive segments). The mode is the number made of all digits.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..jit import njit
from ..numerics.vectors import LANES, address

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

SHAFT, FRICTION, BRANCH = 0, 1, 2
#: Two changes of one digit this close, in samples, come at once (numerics: far above the rounding of the time up to 1e9
#: samples, far below the shortest contact).
AT_ONCE = 1e-6
#: Highest order of the Taylor series that the tables may ask for (layout).
MAX_ORDER = 24
#: Rows of each element in a mode's block (layout).
ELEMENT_ROWS = 4
#: Numbers between a mode's bounds and its series: length of a sub-step, order (layout).
HEADER = 4


class PlantTables(NamedTuple):
    """All modes of a plant, see the module's description."""

    flat: Array  # one block for each row
    row: Indices  # (modes,): row of each mode, −1 while it was never entered
    radix: Indices  # (E,): weight of each element's digit in the mode's number
    kind: Indices  # (E,): SHAFT, FRICTION, or BRANCH of a contact law
    stick: Indices  # (E,): digit of rest, −1 for all but frictions
    speed_row: Array  # (E, N): the speed that is reported with an event
    reset_row: Array  # (E, 3, N + 1): for a shaft's digit 0, 1, 2: the value set on entering, see reset_slot
    reset_slot: Indices  # (E,): state that is set on entering a mode (rest: speed; physical law: shaft angle)
    order: int  # O, of the Taylor series
    idle: int  # column of s that no rate and no guard depends on: the motor angle


def new_work(states: int) -> Array:
    """Scratch of the kernels: change of the state, tolerances of four guards, Taylor series of one."""
    return np.zeros(states + 3 * LANES + MAX_ORDER + 1 + LANES)


class Places(NamedTuple):
    """Addresses of the arrays that events read: handed on as arrays, their counted references would cost more."""

    flat: int
    row: int
    radix: int
    kind: int
    stick: int
    speed_row: int
    reset_row: int
    reset_slot: int
    work: int
    order: int


# forceinline: typed once, which halves the compiling; inline="always" where a caller's sizes must reach the loops.
COMPILED: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy"}
#: Of what only kernels call (a call from Python would crash): wrappers for Python cost compile time.
INNER: Any = {**COMPILED, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


@njit(forceinline=True, **INNER)
def padded(count):
    """Numbers that hold `count` rows in whole groups of LANES."""
    return (count + LANES - 1) & -LANES


@njit(forceinline=True, **INNER)
def block_size(N, C, E, order):
    """Numbers in one mode's block; Python calls ``block_size.py_func``, so it calls no other kernel."""
    high, wide, long = (N + LANES - 1) & -LANES, (E + LANES - 1) & -LANES, (order + LANES) & -LANES
    return C * (high + ELEMENT_ROWS * wide) + 2 * wide + HEADER + order * C * high + E * C * long


@njit(inline="always", **COMPILED)
def places_of(tb, work):
    """Addresses of the tables and of the scratch; the caller keeps both."""
    return Places(
        address(tb.flat), address(tb.row), address(tb.radix), address(tb.kind), address(tb.stick),
        address(tb.speed_row), address(tb.reset_row), address(tb.reset_slot), address(work), tb.order,
    )  # fmt: skip


@njit(inline="always", **COMPILED)
def mode_number(radix, digits, E):
    mode = 0
    for e in range(E):
        mode += digits[e] * radix[e]
    return mode

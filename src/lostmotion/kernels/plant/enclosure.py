"""Whether a guard may leave its bounds within a sample: an enclosure that costs a few products."""

from __future__ import annotations

from ..jit import njit
from ..numerics.vectors import (
    LANES,
    absolute,
    add,
    fused,
    larger,
    less,
    load,
    read,
    smaller,
    splat,
    store,
    subtract,
)
from .layout import COMPILED, ELEMENT_ROWS, INNER, padded

#: Bits of four guards that all stay within their bounds.
ALL = 2**LANES - 1


@njit(inline="always", **COMPILED)
def product(at, table, height, s, C, idle):
    """Four rows at at[table], columns `height` apart, times s; the idle column is left out."""
    rows = load(at, table + (C - 1) * height)
    for j in range(idle):
        rows = fused(load(at, table + j * height), splat(read(s, j)), rows)
    for j in range(idle + 1, C - 1):
        rows = fused(load(at, table + j * height), splat(read(s, j)), rows)
    return rows


@njit(inline="always", **COMPILED)
def absolute_product(at, table, height, s, C, idle):
    """Four rows as in `product`, of absolute values, times |s|."""
    rows = absolute(load(at, table + (C - 1) * height))
    for j in range(idle):
        rows = fused(absolute(load(at, table + j * height)), splat(abs(read(s, j))), rows)
    for j in range(idle + 1, C - 1):
        rows = fused(absolute(load(at, table + j * height)), splat(abs(read(s, j))), rows)
    return rows


@njit(inline="always", **COMPILED)
def two_products(at, table, height, s, C, idle):
    """The four rows at at[table] and the next four times s, at once: neither waits for the other."""
    last = table + (C - 1) * height
    first, second = load(at, last), load(at, last + LANES)
    for j in range(C - 1):
        if j != idle:
            value, column = splat(read(s, j)), table + j * height
            first = fused(load(at, column), value, first)
            second = fused(load(at, column + LANES), value, second)
    return first, second


@njit(inline="always", **COMPILED)
def guards_of(at, table, wide, height, s, C, idle):
    """Four guards whose rows begin at at[table], their rates and swings, at once."""
    last = table + (C - 1) * height
    g, d, swing = load(at, last), load(at, last + wide), load(at, last + 2 * wide)
    for j in range(C - 1):
        if j != idle:
            value, column = splat(read(s, j)), table + j * height
            g = fused(load(at, column), value, g)
            d = fused(load(at, column + wide), value, d)
            swing = fused(load(at, column + 2 * wide), absolute(value), swing)
    return g, d, swing


@njit(forceinline=True, **INNER)
def within(low, g, d, swing, high):
    """Bits of the guards that stay within their bounds: g + d·t ∓ swing·t² is extreme at an end."""
    end = add(g, d)
    inside = less(low, g) & less(g, high)
    return inside & less(low, subtract(end, swing)) & less(add(end, swing), high)


@njit(inline="always", **COMPILED)
def no_crossing(at, s, change, N, C, E, idle):
    """True if no guard can leave its bounds in the whole sample; `change` becomes the state's change over it."""
    wide = padded(E)
    height = padded(N) + ELEMENT_ROWS * wide
    pairs = padded(N) & -2 * LANES
    for i in range(0, pairs, 2 * LANES):
        first, second = two_products(at, i, height, s, C, idle)
        store(change, i, first)
        store(change, i + LANES, second)
    for i in range(pairs, padded(N), LANES):
        store(change, i, product(at, i, height, s, C, idle))
    bounds = C * height
    for e in range(0, wide, LANES):
        guard = padded(N) + e
        g0, d0, swing = guards_of(at, guard, wide, height, s, C, idle)
        low, high = load(at, bounds + e), load(at, bounds + wide + e)
        inside = within(low, g0, d0, swing, high)
        if inside == ALL:
            continue
        # Cubic Hermite through both ends: it lies between its Bernstein points; the remainder bounds its error.
        g1, d1 = g0, d0
        for j in range(N):
            step = splat(read(change, j))
            g1 = fused(load(at, guard + j * height), step, g1)
            d1 = fused(load(at, guard + wide + j * height), step, d1)
        b1, b2 = fused(d0, splat(1.0 / 3.0), g0), fused(d1, splat(-1.0 / 3.0), g1)
        remainder = absolute_product(at, guard + 3 * wide, height, s, C, idle)
        lowest = subtract(smaller(smaller(g0, g1), smaller(b1, b2)), remainder)
        highest = add(larger(larger(g0, g1), larger(b1, b2)), remainder)
        if inside | (less(low, lowest) & less(highest, high)) != ALL:
            return False
    return True

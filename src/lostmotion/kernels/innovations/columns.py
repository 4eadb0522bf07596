"""Columns of ``WIDE`` numbers in flat arrays: sums of their multiples, which stay in registers.

A plain loop stores a column after each term, as the arrays might overlap, and waits for it: a product of two 7 × 7
matrices then takes 130 ns, from these 35 ns (AMD EPYC, 2026-11-24).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..jit import BORROWED, njit
from ..numerics.vectors import LANES, address, fused, load, read, splat, store

COMPILED: Any = {"cache": True, "nogil": True, "fastmath": {"contract"}, "error_model": "numpy"}
#: The same for what makes no array, see ``jit.BORROWED``.
INNER: Any = {**COMPILED, **BORROWED}

#: States at most, in whole registers (layout). Columns are so long: loops of a known length become vector instructions.
WIDE = 3 * LANES
#: Place of a column's last register (layout).
_LAST = 2 * LANES
#: A column of zeros.
NOTHING = np.zeros(WIDE)
#: Zero that is no literal, for what rests and for contacts: numba compiles what takes a literal for that, and then once
#: more for a variable (numerics: a quarter of the time to compile).
NONE: Any = np.int64(0)


@njit(forceinline=True, **INNER)
def add(a, at, factor, out, to):
    """Column of ``out`` at ``to`` += factor · column of ``a`` at ``at``."""
    source, target, wide = address(a), address(out), splat(factor)
    store(target, to, fused(wide, load(source, at), load(target, to)))
    store(target, to + LANES, fused(wide, load(source, at + LANES), load(target, to + LANES)))
    store(target, to + _LAST, fused(wide, load(source, at + _LAST), load(target, to + _LAST)))


@njit(forceinline=True, **INNER)
def combine(f, at, n, b, first, stride, base, base_at, out, to):
    """Column of ``out`` = column of ``base`` + Σ b[first + k·stride] · (column k of f), k from 0 to n − 1.

    The sum stays in registers: numba's own loop stores it after each term, as the arrays might overlap, and waits.
    """
    columns, factors, start, target = address(f), address(b), address(base), address(out)
    low, high, last = load(start, base_at), load(start, base_at + LANES), load(start, base_at + _LAST)
    for k in range(n):
        factor, place = splat(read(factors, first + k * stride)), at + k * WIDE
        low = fused(factor, load(columns, place), low)
        high = fused(factor, load(columns, place + LANES), high)
        last = fused(factor, load(columns, place + _LAST), last)
    store(target, to, low)
    store(target, to + LANES, high)
    store(target, to + _LAST, last)


@njit(forceinline=True, **INNER)
def copy(a, out):
    """A column."""
    source, target = address(a), address(out)
    store(target, 0, load(source, 0))
    store(target, LANES, load(source, LANES))
    store(target, _LAST, load(source, _LAST))


@njit(forceinline=True, **INNER)
def product_of(f, at, nc, b, count, out):
    """out = f·b for ``count`` columns of b; f begins at f[at]."""
    for column in range(count):
        combine(f, at, nc, b, column * WIDE, 1, NOTHING, 0, out, column * WIDE)


@njit(forceinline=True, **INNER)
def turned_product(a, f, at, nc, noise, closed, p):
    """p = a·fᵀ + noise; f begins at f[at]."""
    for r in range(nc):
        combine(a, 0, nc, f, at + r, WIDE, noise, (closed * WIDE + r) * WIDE, p, r * WIDE)
        # Rounding must not make it unsymmetric: that would grow.
        for i in range(r):
            p[r * WIDE + i] = p[i * WIDE + r]

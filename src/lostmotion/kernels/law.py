"""One step of any discrete law: sums from left to right over the nonzero coefficients, then curves.

No fastmath, no contraction, no BLAS: numba, plain Python and the exported C do the very same operations in
the same order, so their results agree bit for bit. Everything that a step calls stays in this module, because
numba's cache does not notice a changed callee in another file.

The step is inlined, which makes it three times as fast: a call counts references to every array that it
passes. So a kernel that calls ``law_step`` must have no fastmath either.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

#: An input outside ±INPUT_BOUND (NaN and infinity included) is replaced by the last good one. Chosen: far
#: above any physical value, and far enough below the largest single-precision number (3.4e38) to multiply it
#: by a gain.
INPUT_BOUND = 1e30


class LawTables(NamedTuple):
    """A discrete law as tables; v = (x, u, w) is the vector of states, checked inputs and curve values.

    Rows come in the order z (one for each curve), y, x⁺. Row r has the coefficients ``value[k]`` on
    ``v[column[k]]`` for k from ``row_start[r]`` to ``row_start[r + 1]``, left to right, nonzero ones only.
    Curve i has the points ``curve_start[i]`` to ``curve_start[i + 1]`` of ``z_point`` and ``w_point``, and
    the slopes of its segments (one more than points) from ``slope[curve_start[i] + i]`` on.
    """

    n_states: int
    n_inputs: int
    n_curves: int
    n_outputs: int
    row_start: NDArray[np.int64]
    column: NDArray[np.int64]
    value: NDArray[np.float64]
    curve_start: NDArray[np.int64]
    z_point: NDArray[np.float64]
    w_point: NDArray[np.float64]
    slope: NDArray[np.float64]


@njit(cache=True, inline="always")
def _row(value, column, start, stop, v):
    total = 0.0
    for k in range(start, stop):
        total += value[k] * v[column[k]]
    return total


@njit(cache=True, inline="always")
def _curve(z_point, w_point, slope, first, last, i, z):
    """Curve i at z, measured from the next point on the left (from the first point if there is none)."""
    k = first
    while k < last and z >= z_point[k]:
        k += 1
    anchor = max(k - 1, first)
    return w_point[anchor] + slope[k + i] * (z - z_point[anchor])


@njit(cache=True, inline="always")
def law_step(tables, state, inputs, outputs, work):
    """One step; returns a bit mask of the inputs that were replaced (bit i for input i), 0 if all were good.

    Parameters
    ----------
    tables : LawTables
    state : (n_states + n_inputs,) array, changed in place
        x, then the last good inputs (0 at the start).
    inputs : (n_inputs,) array
        Raw inputs of this sample.
    outputs : (n_outputs,) array, written
    work : (n_states + n_inputs + n_curves,) array, scratch
    """
    n_states = tables.n_states
    n_inputs = tables.n_inputs
    n_curves = tables.n_curves
    faults = 0
    for i in range(n_inputs):
        given = inputs[i]
        if -INPUT_BOUND <= given <= INPUT_BOUND:
            state[n_states + i] = given
        else:
            faults |= 1 << i
    n_known = n_states + n_inputs
    for i in range(n_known):
        work[i] = state[i]
    # Unpacked once: taking an array out of a tuple costs numba more than a short sum.
    row_start, column, value = tables.row_start, tables.column, tables.value
    curve_start, z_point, w_point, slope = tables.curve_start, tables.z_point, tables.w_point, tables.slope
    for i in range(n_curves):
        z = _row(value, column, row_start[i], row_start[i + 1], work)
        work[n_known + i] = _curve(z_point, w_point, slope, curve_start[i], curve_start[i + 1], i, z)
    row = n_curves
    for i in range(tables.n_outputs):
        outputs[i] = _row(value, column, row_start[row], row_start[row + 1], work)
        row += 1
    for i in range(n_states):
        state[i] = _row(value, column, row_start[row], row_start[row + 1], work)
        row += 1
    return faults


@njit(cache=True)
def law_run(tables, state, inputs):
    """All rows of ``inputs`` (n, n_inputs) in turn; ``state`` (layout of ``law_step``) ends as the final one.

    Returns the outputs (n, n_outputs) and the fault masks (n,).
    """
    n = inputs.shape[0]
    outputs = np.empty((n, tables.n_outputs))
    faults = np.zeros(n, dtype=np.int64)
    work = np.empty(tables.n_states + tables.n_inputs + tables.n_curves)
    for k in range(n):
        faults[k] = law_step(tables, state, inputs[k], outputs[k], work)
    return outputs, faults

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

#: Of a check: an error beyond LEARNED times the largest of late is a jump; that one grows by no more than WIDEN times
#: the bound at once, and by RAISE of the first error of a jump (all chosen).
LEARNED, WIDEN, RAISE = 1.5, 8.0, 0.125
#: After a jump a sample is good within CLOSER times the limit. Frozen is what came SAME times while its prediction moved
#: by MOVED times the largest step of late (all chosen).
CLOSER, SAME, MOVED = 0.5, 5.0, 0.75

#: An input outside ±INPUT_BOUND (NaN and infinity included) is replaced by the last good one. Chosen: far
#: above any physical value, and far enough below the largest single-precision number (3.4e38) to multiply it
#: by a gain.
INPUT_BOUND = 1e30


class LawTables(NamedTuple):
    """A discrete law as tables; v = (x, u, w) is the vector of states, checked inputs and curve values.

    Rows come in the order z (one for each curve), y, x⁺, p (the prediction of each checked input). Row r has the coefficients ``value[k]`` on
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
    n_early: int  # curves that are evaluated before the inputs are checked
    checked: NDArray[np.int64]  # inputs with a check, and those without
    plain: NDArray[np.int64]
    limit: NDArray[np.float64]  # of each check, see ``systems.InputCheck``
    hold: NDArray[np.float64]
    forget: NDArray[np.float64]
    keep: NDArray[np.int64]


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
def _bad(state, at, given, predicted, limit, hold, forget):
    """Whether a sample is bad: 0 good, 1 taken although it is, 2 to be replaced; what is remembered starts at ``at``.

    Parameters as in ``systems.InputCheck``; ``given`` and ``predicted`` may be anything.
    """
    missing = not -INPUT_BOUND <= given <= INPUT_BOUND
    doubt = state[at + 3]
    frozen = False
    jump = False
    if missing or not -INPUT_BOUND <= predicted <= INPUT_BOUND:
        state[at + 1] = 0.0
        if not missing:
            return 0
    else:
        error = abs(given - predicted)
        # After a jump a sample must come closer to be good.
        bound = max(limit if state[at + 1] >= 0.0 else CLOSER * limit, LEARNED * state[at + 4])
        jump = error > bound
        step = 0.0
        if state[at + 1] > 0.0 and given == state[at]:
            state[at + 1] += 1.0
            moved = min(abs(predicted - state[at + 2]), error)
            frozen = state[at + 1] >= SAME and 0.0 < MOVED * state[at + 5] < moved
        else:
            if state[at + 1] == 1.0:
                step = abs(given - state[at])
            state[at] = given
            state[at + 1] = 1.0
            state[at + 2] = predicted
        if jump and doubt < hold:
            state[at + 1] = -1.0
            if doubt == 0.0:
                state[at + 4] += RAISE * (min(error, WIDEN * bound) - state[at + 4])
        else:
            state[at + 4] = max(min(error, WIDEN * bound), forget * state[at + 4])
            if step > 0.0:
                state[at + 5] = max(min(step, bound), forget * state[at + 5])
    if doubt < hold:
        if missing or frozen or jump:
            state[at + 3] = doubt + 1.0 if doubt + 1.0 < hold else 2.0 * hold
            return 2
        state[at + 3] = 0.0
    elif jump:
        state[at + 3] = 2.0 * hold
    elif not (missing or frozen):
        state[at + 3] = doubt - 1.0 if doubt > hold + 1.0 else 0.0
    return 2 if missing else int(frozen)


@njit(cache=True, inline="always")
def law_step(tables, state, inputs, outputs, work):
    """One step; returns a bit mask of the inputs that were bad (bit i for input i), 0 if all were good.

    Parameters
    ----------
    tables : LawTables
    state : (n_states + n_inputs + 6 n_checks,) array, changed in place
        x, then the last good inputs (0 at the start), then what each check remembers: ``DiscreteSystem.start``.
    inputs : (n_inputs,) array
        Raw inputs of this sample.
    outputs : (n_outputs,) array, written
    work : (n_states + n_inputs + n_curves,) array, scratch
    """
    n_states = tables.n_states
    n_inputs = tables.n_inputs
    n_curves = tables.n_curves
    n_known = n_states + n_inputs
    # Unpacked once: taking an array out of a tuple costs numba more than a short sum.
    row_start, column, value = tables.row_start, tables.column, tables.value
    curve_start, z_point, w_point, slope = tables.curve_start, tables.z_point, tables.w_point, tables.slope
    faults = 0
    for i in tables.plain:
        given = inputs[i]
        if -INPUT_BOUND <= given <= INPUT_BOUND:
            state[n_states + i] = given
        else:
            faults |= 1 << i
    for i in range(n_known):
        work[i] = state[i]
    for i in range(tables.n_early):
        z = _row(value, column, row_start[i], row_start[i + 1], work)
        work[n_known + i] = _curve(z_point, w_point, slope, curve_start[i], curve_start[i + 1], i, z)
    row = n_curves + tables.n_outputs + n_states
    at = n_known
    for j in range(tables.checked.size):
        i = tables.checked[j]
        given = inputs[i]
        predicted = _row(value, column, row_start[row], row_start[row + 1], work)
        bad = _bad(state, at, given, predicted, tables.limit[j], tables.hold[j], tables.forget[j])
        if bad > 0:
            faults |= 1 << i
        if bad < 2:
            state[n_states + i] = given
        elif tables.keep[j] == 0 and -INPUT_BOUND <= predicted <= INPUT_BOUND:
            state[n_states + i] = predicted
        work[n_states + i] = state[n_states + i]
        row += 1
        at += 6
    for i in range(tables.n_early, n_curves):
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

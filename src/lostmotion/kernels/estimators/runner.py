"""Any stepper, sample by sample: a law whose step is a compiled function instead of tables.

A step is passed as a *function pointer* of one fixed signature. So this loop is compiled and cached once for all
steppers, and each step once in its own module; an indirect call costs some ten nanoseconds.
"""

from __future__ import annotations

import numpy as np
from numba import types

from ..jit import njit
from .verdicts import INPUT_BOUND

_ARRAY = types.float64[::1]

#: ``step(parameters, state, inputs, faults, outputs) → faults``: changes state, writes outputs. ``inputs`` are already
#: replaced where they were bad, ``faults`` has bit i set for input i; the step may set more bits.
STEP = types.int64(_ARRAY, _ARRAY, _ARRAY, types.int64, _ARRAY)
#: ``init(parameters) → state``.
INIT = _ARRAY(_ARRAY)

_STEP_POINTER = types.FunctionType(STEP)


@njit(types.int64(_STEP_POINTER, _ARRAY, _ARRAY, _ARRAY, _ARRAY, _ARRAY), cache=True)
def checked_step(step, parameters, state, inputs, good, outputs):
    """One step; NaN, infinity and absurd inputs are flagged, and the last good input takes their place.

    The state ends with the last good inputs; ``good`` is scratch.
    """
    n = inputs.size
    start = state.size - n
    faults = 0
    for i in range(n):
        given = inputs[i]
        if -INPUT_BOUND <= given <= INPUT_BOUND:  # NaN fails both
            state[start + i] = given
        else:
            faults |= 1 << i
        good[i] = state[start + i]
    return step(parameters, state, good, faults, outputs)


@njit(
    types.Tuple((types.float64[:, ::1], types.int64[::1]))(
        _STEP_POINTER, _ARRAY, _ARRAY, types.float64[:, ::1], types.int64
    ),
    cache=True,
)
def run_stepper(step, parameters, state, inputs, n_outputs):
    """All rows of ``inputs`` (n, n_inputs) in turn; ``state`` ends as the final one.

    Returns the outputs (n, n_outputs) and the fault masks (n,).
    """
    n = inputs.shape[0]
    outputs = np.empty((n, n_outputs))
    faults = np.zeros(n, dtype=np.int64)
    good = np.empty(inputs.shape[1])
    for k in range(n):
        faults[k] = checked_step(step, parameters, state, inputs[k], good, outputs[k])
    return outputs, faults

"""Signals of a plant out of its states: in every contact state a row over states, inputs and one."""

from __future__ import annotations

from typing import Any

from numba import njit

#: No fastmath: a signal is the same sum in the same order wherever it is worked out.
_COMPILED: Any = {"cache": True, "error_model": "numpy", "nogil": True}


@njit(**_COMPILED)
def fill_signals(entered, states, modes, first, count, values):
    """`count` samples of all signals, from the sample `first` on; states and modes are those of these samples.

    Parameters
    ----------
    entered : Entered
    states : (count or more, N), modes : likewise, int64
    values : (signals, n) array
        Written; inputs count as zero.
    """
    columns = entered.signal.shape[2]
    differs = False
    for j in range(values.shape[0]):
        alike = True
        for m in range(columns, entered.weights.shape[1]):
            alike = alike and entered.weights[j, m] == 0.0
        if alike:
            _fill(entered.signal[0, j], entered.span[0, j], states, 0, count, values[j], first)
        differs = differs or not alike
    k = 0
    while differs and k < count:
        mode, stop = modes[k], k + 1
        while stop < count and modes[stop] == mode:
            stop += 1
        row = entered.tables.row[mode]
        for j in range(values.shape[0]):
            for m in range(columns, entered.weights.shape[1]):
                if entered.weights[j, m] != 0.0:
                    _fill(entered.signal[row, j], entered.span[row, j], states, k, stop, values[j], first)
                    break
        k = stop


@njit(**_COMPILED)
def _fill(row, span, states, start, stop, values, first):
    """The samples `start` to `stop` of one signal in one contact state."""
    a, b, constant = span[0], min(span[1], states.shape[1]), row[row.size - 1]
    if b - a == 1:
        factor = row[a]
        for k in range(start, stop):
            values[first + k] = factor * states[k, a] + constant
    elif b - a == 4:
        w, x, y, z = row[a], row[a + 1], row[a + 2], row[a + 3]
        for k in range(start, stop):
            total = w * states[k, a] + x * states[k, a + 1] + y * states[k, a + 2] + z * states[k, a + 3]
            values[first + k] = total + constant
    else:
        for k in range(start, stop):
            total = 0.0
            for c in range(a, b):
                total += row[c] * states[k, c]
            values[first + k] = total + constant

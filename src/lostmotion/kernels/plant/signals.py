"""Signals of a plant out of its states: in every mode a row over states, inputs and one."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray


def same(rows: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(signals,): whether a signal's row is the same in all modes of (modes, signals, C)."""
    return np.asarray((rows == rows[:1]).all(axis=(0, 2)))


def spans(rows: NDArray[np.float64]) -> NDArray[np.int64]:
    """(…, 2): first column of each row of (…, C) that is not zero, and the one after the last; 0, 0 where all are."""
    used = rows != 0.0
    stop = np.where(used.any(axis=-1), rows.shape[-1] - np.argmax(used[..., ::-1], axis=-1), 0)
    return np.stack([np.argmax(used, axis=-1), stop], axis=-1).astype(np.int64)


@njit(cache=True, error_model="numpy")
def signals_of(states, modes, row_of_mode, rows, span, alike):
    """(signals, n) values at n samples; inputs count as zero.

    Parameters
    ----------
    states : (n, N) array
    modes : (n,) int64 array
    row_of_mode : (modes,) int64 array
    rows : (entered modes, signals, C) array, C ≥ N + 1: over states, inputs, one
    span : (entered modes, signals, 2) int64 array, see ``spans``
    alike : (signals,) array of bool, see ``same``
    """
    values = np.empty((rows.shape[1], states.shape[0]))
    n_states, one = states.shape[1], rows.shape[2] - 1
    for j in range(rows.shape[1]):
        first, stop = span[0, j, 0], min(span[0, j, 1], n_states)
        if first < n_states and stop <= first + 1 and alike[j]:
            # As most signals, it is one state in all modes, and not worth a look at the mode.
            factor = rows[0, j, first]
            for k in range(states.shape[0]):
                values[j, k] = factor * states[k, first] + rows[0, j, one]
        else:
            for k in range(states.shape[0]):
                m = row_of_mode[modes[k]]
                total = 0.0
                for c in range(span[m, j, 0], min(span[m, j, 1], n_states)):
                    total += rows[m, j, c] * states[k, c]
                values[j, k] = total + rows[m, j, one]
    return values

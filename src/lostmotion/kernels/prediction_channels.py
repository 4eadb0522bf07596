"""Innovations of any observer in Lur'e form over pieces of a recording, without holding the interpreter's lock."""

from __future__ import annotations

import numpy as np
from numba import njit

from .law import law_step


@njit(cache=True, nogil=True)
def channel_innovations(tables, starts, bounds, inputs, weights):
    """(n, m) outputs of the law times ``weights`` (m,), for a law whose outputs are its innovations.

    Parameters
    ----------
    tables : LawTables
    starts : (p, n_states) array
        State at the first row of each of p pieces.
    bounds : (p + 1,) int array
        First row of each piece, and n.
    inputs : (n, n_inputs) array
    weights : (m,) array
    """
    weighted = np.empty((inputs.shape[0], tables.n_outputs))
    work = np.empty(tables.n_states + tables.n_inputs + tables.n_curves)
    state = np.zeros(tables.n_states + tables.n_inputs)
    outputs = np.empty(tables.n_outputs)
    for piece in range(bounds.size - 1):
        for i in range(tables.n_states):
            state[i] = starts[piece, i]
        for k in range(bounds[piece], bounds[piece + 1]):
            law_step(tables, state, inputs[k], outputs, work)
            for j in range(outputs.size):
                weighted[k, j] = outputs[j] * weights[j]
    return weighted

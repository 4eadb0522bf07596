"""Signals of a plant out of its states: in every contact state a row over states, inputs and one."""

from __future__ import annotations

from ..jit import njit
from ..numerics.vectors import LANES, address, columns_of, fused, load, read, splat, store
from .layout import COMPILED


@njit(nogil=True, **COMPILED)
def fill_signals(entered, states, modes, first, count, values):
    """`count` samples of all signals, from the sample `first` on; states and modes are those of these samples.

    Parameters
    ----------
    entered : Entered
    states : (count or more, N), modes : likewise, int64
    values : (signals, n) array
        Written; inputs count as zero.
    """
    k = 0
    while k < count:
        mode, stop = modes[k], k + 1
        while stop < count and modes[stop] == mode:
            stop += 1
        row = entered.tables.row[mode]
        if states.shape[1] == LANES:
            whole = k + ((stop - k) & -LANES)
            _fill_by_fours(entered, row, states, k, whole, first, values)
            _fill(entered, row, states, whole, stop, first, values)
        else:
            _fill(entered, row, states, k, stop, first, values)
        k = stop


@njit(nogil=True, **COMPILED)
def _fill_by_fours(entered, row, states, start, stop, first, values):
    """The samples `start` to `stop`, all in one contact state, where the plant has four states."""
    at, to, n = address(states), address(values) + 8 * first, values.shape[1]
    signals, columns = entered.signal.shape[1], entered.signal.shape[2]
    rows = address(entered.signal) + 8 * row * signals * columns
    for k in range(start, stop, LANES):
        w, x, y, z = columns_of(
            load(at, LANES * k),
            load(at, LANES * (k + 1)),
            load(at, LANES * (k + 2)),
            load(at, LANES * (k + 3)),
        )
        for j in range(signals):
            factors = rows + 8 * j * columns
            value = fused(splat(read(factors, 0)), w, splat(read(factors, columns - 1)))
            value = fused(splat(read(factors, 1)), x, value)
            value = fused(splat(read(factors, 2)), y, value)
            value = fused(splat(read(factors, 3)), z, value)
            store(to + 8 * j * n, k, value)


@njit(nogil=True, **COMPILED)
def _fill(entered, row, states, start, stop, first, values):
    """The samples `start` to `stop`, all in one contact state."""
    signal, span = entered.signal[row], entered.span[row]
    for j in range(values.shape[0]):
        a, b, constant = span[j, 0], min(span[j, 1], states.shape[1]), signal[j, signal.shape[1] - 1]
        for k in range(start, stop):
            value = constant
            for c in range(a, b):
                value += signal[j, c] * states[k, c]
            values[j, first + k] = value

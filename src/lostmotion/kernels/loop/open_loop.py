"""A plant under given torques, block by block: a block's states stay in the cache while its signals are made."""

from __future__ import annotations

from numba import njit

from ..plant.entered import enter
from ..plant.event_loop import DONE, NEED_MODE, run_open_loop
from ..plant.layout import COMPILED
from ..plant.signals import fill_signals
from .two_mass import run_open_loop_two_mass


@njit(nogil=True, **COMPILED)
def run_blocks(entered, two_mass, s, digits, inputs, work, states, modes, events, cursor, values):
    """All samples of a plant under given torques, and its signals; returns a status.

    Parameters
    ----------
    entered : Entered
    two_mass : bool
        Whether the plant has four states, one torque and two elements.
    s, digits, inputs, work, events, cursor
        As in ``event_loop.run_open_loop``; cursor[5] is the first sample of the block that is worked on.
    states : (block + 1, N), modes : (block + 1,) int64
        Of the block that is worked on; at the end that of the last one, the sample after the last included.
    values : (signals, n) array
        Filled.
    """
    tb, n, block = entered.tables, inputs.shape[0], states.shape[0] - 1
    first = int(cursor[5])
    while True:
        stop = min(first + block, n)
        if two_mass:
            status = run_open_loop_two_mass(
                tb, s, digits, inputs, first, stop, work, states, modes, events, cursor
            )
        else:
            status = run_open_loop(tb, s, digits, inputs, first, stop, work, states, modes, events, cursor)
        if status == NEED_MODE and enter(entered, digits):
            continue
        if status != DONE:
            return status
        fill_signals(entered, states, modes, first, stop - first, values)
        if stop == n:
            return DONE
        first = stop
        cursor[5] = first

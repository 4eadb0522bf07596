"""A plant with one law in the loop, block by block, whichever kernel knows the plant."""

from __future__ import annotations

from numba import njit

from ..plant.entered import enter
from ..plant.event_loop import DONE, NEED_MODE
from ..plant.layout import COMPILED
from ..plant.signals import fill_signals
from .one_law import run_closed_loop
from .two_mass import run_closed_loop_two_mass


@njit(nogil=True, **COMPILED)
def run_with_law(entered, two_mass, s, digits, loop, work, states, modes, events, cursor, values):
    """As ``open_loop.run_blocks``, with the law of ``one_law.LoopTables`` in place of given torques."""
    n, block = loop.torque.shape[0], states.shape[0] - 1
    first = int(cursor[5])
    while True:
        stop = min(first + block, n)
        if two_mass:
            status = run_closed_loop_two_mass(
                entered, s, digits, loop, first, stop, work, states, modes, events, cursor
            )
        else:
            status = run_closed_loop(
                entered, s, digits, loop, first, stop, work, states, modes, events, cursor
            )
        if status == NEED_MODE and enter(entered, digits):
            continue
        if status != DONE:
            return status
        fill_signals(entered, states, modes, first, stop - first, values)
        if stop == n:
            return DONE
        first = stop
        cursor[5] = first

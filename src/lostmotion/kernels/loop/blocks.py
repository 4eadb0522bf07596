"""A whole simulation, block by block: a block's states stay in the cache while its signals are made."""

from __future__ import annotations

from typing import Any

from ..jit import njit
from ..plant.entered import enter
from ..plant.event_loop import DONE, NEED_MODE
from ..plant.layout import COMPILED
from ..plant.signals import fill_signals
from .any_plant import run_closed_loop, run_open_loop
from .two_mass import run_closed_loop_two_mass, run_open_loop_two_mass


def _block_loop(with_laws: bool) -> Any:
    """The blocks under given torques or with laws; numba leaves out the branches of the other one."""

    @njit(inline="always", nogil=True, **COMPILED)
    def run(entered, two_mass, source, steps, n, s, digits, work, states, modes, events, cursor, values):
        tb, block = entered.tables, states.shape[0] - 1
        first = int(cursor[5])
        while True:
            stop = min(first + block, n)
            if with_laws:
                if two_mass:
                    status = run_closed_loop_two_mass(
                        entered, s, digits, source, steps, first, stop, work, states, modes, events, cursor
                    )
                else:
                    status = run_closed_loop(
                        entered, s, digits, source, steps, first, stop, work, states, modes, events, cursor
                    )
            elif two_mass:
                status = run_open_loop_two_mass(
                    tb, s, digits, source, first, stop, work, states, modes, events, cursor
                )
            else:
                status = run_open_loop(
                    tb, s, digits, source, first, stop, work, states, modes, events, cursor
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

    return run


_under_torques, _with_laws = _block_loop(False), _block_loop(True)


@njit(nogil=True, **COMPILED)
def run_under_torques(entered, two_mass, s, digits, inputs, work, states, modes, events, cursor, values):
    """All samples of a plant under given torques, and its signals; returns a status.

    Parameters
    ----------
    entered : Entered
    two_mass : bool
        Whether the plant has four states, one torque and two elements.
    s, digits, inputs, work, events, cursor
        As in ``any_plant.run_open_loop``; cursor[5] is the first sample of the block that is worked on.
    states : (block + 1, N), modes : (block + 1,) int64
        Of the block that is worked on; at the end that of the last one, the sample after the last included.
    values : (signals, n) array
        Filled.
    """
    return _under_torques(
        entered, two_mass, inputs, None, inputs.shape[0], s, digits, work, states, modes, events, cursor, values,
    )  # fmt: skip


@njit(nogil=True, **COMPILED)
def run_with_laws(entered, two_mass, s, digits, loop, steps, work, states, modes, events, cursor, values):
    """`run_under_torques` with laws in the loop, see ``any_plant.run_closed_loop``."""
    return _with_laws(
        entered, two_mass, loop, steps, loop.torque.shape[0], s, digits, work, states, modes, events, cursor, values,
    )  # fmt: skip

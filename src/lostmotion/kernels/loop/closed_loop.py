"""Any plant with laws in the loop, block by block: sensors and laws, then one exact sample of the plant."""

from __future__ import annotations

from numba import njit

from ..numerics.vectors import address, read, write, write_integer
from ..plant.enclosure import no_crossing
from ..plant.entered import enter
from ..plant.event_loop import DONE, NEED_MODE, add_change, copy_state, finish_sample
from ..plant.layout import COMPILED, block_size, mode_number, places_of
from ..plant.signals import fill_signals
from .laws import ALGEBRAIC_LOOP, control, loop_places
from .two_mass import run_closed_loop_two_mass


@njit(nogil=True, **COMPILED)
def run_with_laws(entered, two_mass, s, digits, loop, steps, work, states, modes, events, cursor, values):
    """As ``open_loop.run_blocks``, with laws in place of given torques.

    Parameters
    ----------
    loop : Loop
    steps : typed list
        The steppers' step functions, see ``laws.no_steps``.
    """
    n, block = loop.torque.shape[0], states.shape[0] - 1
    first = int(cursor[5])
    while True:
        stop = min(first + block, n)
        if two_mass:
            status = run_closed_loop_two_mass(
                entered, s, digits, loop, steps, first, stop, work, states, modes, events, cursor
            )
        else:
            status = run_closed_loop(
                entered, s, digits, loop, steps, first, stop, work, states, modes, events, cursor
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


@njit(**COMPILED)
def run_closed_loop(entered, s, digits, loop, steps, first, stop, work, states, modes, events, cursor):
    """Samples `first` to `stop`; as ``event_loop.run_open_loop``, and cursor[4] is the torque of the last sample."""
    tb = entered.tables
    E = digits.size
    M = loop.torque.shape[1]
    C = s.size
    N = C - M - 1
    row, radix, idle, places, p = tb.row, tb.radix, tb.idle, places_of(tb, work), loop_places(entered, loop)
    base, x, change = places.flat, address(s), address(work)
    kept, number, speed = address(states) - 8 * N * first, address(modes) - 8 * first, address(loop.speed)
    size = block_size(N, C, E, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    last = cursor[4]
    status = DONE
    mode = mode_number(radix, digits, E)
    while k < stop:
        m = row[mode]
        if m < 0:
            status = NEED_MODE
            break
        quiet = False
        if not begun:
            if loop.slot >= 0:
                write(x, loop.slot, read(speed, k))
            copy_state(x, kept + 8 * k * N, N)
            write_integer(number, k, mode)
            settled, last = control(p, steps, m, x, k, last)
            if not settled:
                status = ALGEBRAIC_LOOP
                break
            quiet = no_crossing(base + 8 * m * size, x, change, N, C, E, idle)
        if quiet:
            add_change(x, change, N)
        else:
            status, start, count = finish_sample(
                places, x, address(digits), start, k, address(events), events.shape[0], count, N, C, E, idle
            )
            mode = mode_number(radix, digits, E)
            if status != DONE:
                begun = True
                break
            start, begun = 0.0, False
        k += 1
    cursor[0], cursor[1], cursor[2], cursor[3], cursor[4] = k, start, count, begun, last
    if status == DONE:
        copy_state(x, kept + 8 * k * N, N)
        write_integer(number, k, mode)
    return status

"""Any plant from sample to sample: its torques are given, or laws make them."""

from __future__ import annotations

from typing import Any

from ..jit import njit
from ..numerics.vectors import address, write, write_integer
from ..plant.enclosure import no_crossing
from ..plant.event_loop import DONE, NEED_MODE, add_change, copy_state, finish_sample
from ..plant.layout import COMPILED, INNER, block_size, mode_number, places_of
from .laws import ALGEBRAIC_LOOP, control, loop_places


def _any_plant_loop(with_laws: bool) -> Any:
    """The loop under given torques or with laws; numba leaves out the branches of the other one."""

    @njit(**INNER)
    def run(tb, entered, source, steps, s, digits, inputs, first, stop, work, states, modes, events, cursor):
        E, M, C = digits.size, inputs, s.size
        N = C - M - 1
        row, radix, idle, places = tb.row, tb.radix, tb.idle, places_of(tb, work)
        base, x, change = places.flat, address(s), address(work)
        kept, number = address(states) - 8 * N * first, address(modes) - 8 * first
        size = block_size(N, C, E, tb.order)
        k = int(cursor[0])
        start = cursor[1]
        count = int(cursor[2])
        begun = cursor[3] != 0.0
        last = cursor[4]
        status = DONE
        mode = mode_number(radix, digits, E)
        if with_laws:
            p = loop_places(entered, source)
        while k < stop:
            m = row[mode]
            if m < 0:
                status = NEED_MODE
                break
            quiet = False
            if not begun:
                if with_laws:
                    if source.slot >= 0:
                        write(x, source.slot, source.speed[k])
                else:
                    for j in range(M):
                        write(x, N + j, source[k, j])
                copy_state(x, kept + 8 * k * N, N)
                write_integer(number, k, mode)
                if with_laws:
                    settled, last = control(p, steps, m, x, k, last)
                    if not settled:
                        status = ALGEBRAIC_LOOP
                        break
                quiet = no_crossing(base + 8 * m * size, x, change, N, C, E, idle)
            if quiet:
                add_change(x, change, N)
            else:
                status, start, count = finish_sample(
                    places,
                    x,
                    address(digits),
                    start,
                    k,
                    address(events),
                    events.shape[0],
                    count,
                    N,
                    C,
                    E,
                    idle,
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

    return run


_under_torques, _with_laws = _any_plant_loop(False), _any_plant_loop(True)


@njit(inline="always", **COMPILED)
def run_open_loop(tb, s, digits, inputs, first, stop, work, states, modes, events, cursor):
    """The samples `first` to `stop` under given torques; returns a status of ``event_loop``.

    Parameters
    ----------
    tb : PlantTables
    s : (C,) array
        [x, v, 1], changed in place.  digits : (E,) int64, changed in place.
    inputs : (n, M) array
    work : (W,) array
        See `new_work`.
    states : (stop − first + 1 or more, N), modes : likewise, int64
        Filled from the sample `first` on, the one after the last included.
    events : (space, EVENT_COLUMNS + N) array
    cursor : (5 or more,) array
        Where to go on after NEED_MODE or NEED_EVENT_SPACE: sample, time within it (in samples), events so far, and 1
        if the sample was begun; then the torque set-point of the last sample.
    """
    return _under_torques(
        tb, None, inputs, None, s, digits, inputs.shape[1], first, stop, work, states, modes, events, cursor
    )


@njit(inline="always", **COMPILED)
def run_closed_loop(entered, s, digits, loop, steps, first, stop, work, states, modes, events, cursor):
    """`run_open_loop` with the laws of a ``laws.Loop``; steps: the steppers' step functions, see ``laws.no_steps``."""
    return _with_laws(
        entered.tables, entered, loop, steps, s, digits, loop.torque.shape[1], first, stop, work, states, modes,
        events, cursor,
    )  # fmt: skip

"""The two-mass plant, open loop and with laws: four states, one torque, two elements, the state in registers."""

from __future__ import annotations

from typing import Any

from ..jit import njit
from ..numerics.vectors import (
    absolute,
    add,
    address,
    fused,
    load,
    multiply,
    splat,
    spread,
    store,
    write_integer,
)  # fmt: skip
from ..plant.enclosure import ALL, no_crossing, within
from ..plant.event_loop import DONE, NEED_MODE, finish_sample
from ..plant.layout import COMPILED, INNER, block_size, mode_number, places_of
from .laws import ALGEBRAIC_LOOP, control, loop_places

#: Rows of a two-mass plant's columns: four of the state, four groups of guards (layout).
TWO_MASS_ROWS = 20


@njit(forceinline=True, **INNER)
def four_rows(at, table, x0, x1, x2, v):
    """Four rows of the two-mass plant times its state and torque; in this order the sum waits least for the state."""
    rest = fused(load(at, table + 4 * TWO_MASS_ROWS), v, load(at, table + 5 * TWO_MASS_ROWS))
    late = fused(load(at, table + TWO_MASS_ROWS), x1, multiply(load(at, table + 2 * TWO_MASS_ROWS), x2))
    return add(fused(load(at, table), x0, rest), late)


@njit(forceinline=True, **INNER)
def _finish(places, address_s, digits, radix, start, k, events, count):
    """The rest of sample k by `finish_sample`; returns status, where it goes on (0 if it ended), events, the mode."""
    status, reached, count = finish_sample(
        places, address_s, address(digits), start, k, address(events), events.shape[0], count, 4, 6, 2, 3
    )
    if status == DONE:
        reached = 0.0
    return status, reached, count, mode_number(radix, digits, 2)


def _two_mass_loop(with_laws: bool) -> Any:
    """The loop under given torques or with laws; numba leaves out the branches of the other one."""

    @njit(**INNER)
    def run(tb, entered, source, steps, s, digits, first, stop, work, states, modes, events, cursor):
        row, radix = tb.row, tb.radix
        places = places_of(tb, work)
        base, address_s, change = places.flat, address(s), address(work)
        rows, number = address(states) - 8 * 4 * first, address(modes) - 8 * first
        size = block_size(4, 6, 2, tb.order)
        k = int(cursor[0])
        start = cursor[1]
        count = int(cursor[2])
        begun = cursor[3] != 0.0
        last = cursor[4]
        status = DONE
        mode = mode_number(radix, digits, 2)
        m = row[mode]
        at = base + 8 * m * size
        x = load(address_s, 0)
        if with_laws:
            p = loop_places(entered, source)
        while k < stop:
            if m < 0:
                status = NEED_MODE
                break
            if not begun:
                store(rows, 4 * k, x)
                write_integer(number, k, mode)
                if with_laws:
                    store(address_s, 0, x)
                    settled, last = control(p, steps, m, address_s, k, last)
                    if not settled:
                        status = ALGEBRAIC_LOOP
                        break
                else:
                    last = source[k, 0]
                x0, x1, x2, v = spread(x, 0), spread(x, 1), spread(x, 2), splat(last)
                g = four_rows(at, 4, x0, x1, x2, v)
                d = four_rows(at, 8, x0, x1, x2, v)
                swing = four_rows(at, 12, absolute(x0), absolute(x1), absolute(x2), absolute(v))
                low, high = load(at, 6 * TWO_MASS_ROWS), load(at, 6 * TWO_MASS_ROWS + 4)
                if within(low, g, d, swing, high) == ALL:
                    x = add(x, four_rows(at, 0, x0, x1, x2, v))
                    k += 1
                    continue
                store(address_s, 0, x)
                s[4] = last
            if not begun and no_crossing(at, address_s, change, 4, 6, 2, 3):
                x = add(x, load(change, 0))
            else:
                status, start, count, mode = _finish(
                    places, address_s, digits, radix, start, k, events, count
                )
                m = row[mode]
                at = base + 8 * m * size
                begun = status != DONE
                if begun:
                    break
                x = load(address_s, 0)
            k += 1
        cursor[0], cursor[1], cursor[2], cursor[3], cursor[4] = k, start, count, begun, last
        if status == DONE or not begun:
            store(address_s, 0, x)
        if status == DONE:
            store(rows, 4 * k, x)
            write_integer(number, k, mode)
        return status

    return run


_under_torques, _with_laws = _two_mass_loop(False), _two_mass_loop(True)


@njit(inline="always", **COMPILED)
def run_open_loop_two_mass(tb, s, digits, inputs, first, stop, work, states, modes, events, cursor):
    """`run_open_loop` for four states, one input, two elements, with the state in registers (half the time)."""
    return _under_torques(tb, None, inputs, None, s, digits, first, stop, work, states, modes, events, cursor)


@njit(inline="always", **COMPILED)
def run_closed_loop_two_mass(
    entered, s, digits, loop, steps, first, stop, work, states, modes, events, cursor
):
    """`run_open_loop_two_mass` with laws in the loop, see ``any_plant.run_closed_loop``."""
    return _with_laws(
        entered.tables, entered, loop, steps, s, digits, first, stop, work, states, modes, events, cursor
    )

"""Exact event-driven simulation of a piecewise-linear plant: from event to event, no step size, no tolerance.

The plant is what ``plant_tables`` describes. A sample in which the enclosure excludes every crossing is one matrix
product. Otherwise the guards that may cross are expanded in their Taylor series (converged to rounding), the first
crossing is found on that polynomial by steps that can be shown never to jump over a root, and the rest of the sample
goes on from there in the next mode.

Impact, bounce, separation, sticking and slipping are decided alike: a guard leaves its bounds. Guards and bounds of
each contact law are in ``equations._guard_rows``; ``_next_event`` finds which guard is first, ``_enter`` changes the
contact state. A bounce is a separation and an impact shortly after; nothing else is done for it.

Two habits make it fast: four rows go through one register, and arrays are read by address (``vectors``), without tests
of the index and without numba's counting of references.
"""

from __future__ import annotations

from ..jit import njit
from ..numerics.vectors import (
    LANES,
    absolute,
    add,
    fused,
    less,
    load,
    multiply,
    pack,
    read,
    read_integer,
    splat,
    store,
    subtract,
    total,
    write,
    write_integer,
)
from .crossings import first_crossing
from .enclosure import absolute_product, guards_of, product
from .layout import (
    COMPILED,
    ELEMENT_ROWS,
    FRICTION,
    HEADER,
    INNER,
    block_size,
    padded,
)

DONE, NEED_MODE, NEED_EVENT_SPACE, CHATTERING = 0, 1, 2, 3
#: Events within one sample beyond which the run is given up as chattering (option).
MAX_EVENTS_PER_SAMPLE = 10_000
#: An event's row: time in samples, element, old digit, new digit, speed at the element, new mode; then the state.
#: (Layout.)
EVENT_COLUMNS = 6


@njit(inline="always", **COMPILED)
def empty_event_space(status, cursor, crowd):
    """The status after a run whose events have been read: CHATTERING where one sample fills the space on and on.

    crowd (2,): the sample whose space was full, and its events so far; −1 at the start. A run sees one space at a time.
    """
    if status != NEED_EVENT_SPACE:
        return status
    crowd[1] = crowd[1] + cursor[2] if cursor[0] == crowd[0] else cursor[2]
    crowd[0] = cursor[0]
    cursor[2] = 0.0
    return CHATTERING if crowd[1] > MAX_EVENTS_PER_SAMPLE else NEED_EVENT_SPACE


@njit(inline="always", **COMPILED)
def _expand(at, table, rows, s, p, order, C, idle):
    """Taylor series of the guard whose table starts at at[table], to p; returns what bounds the change of its slope."""
    first = product(at, table, rows, s, C, idle)
    store(p, 0, first)
    weight = pack(0.0, 0.0, 2.0, 3.0)
    bend = multiply(absolute(first), weight)
    weight = pack(4.0, 5.0, 6.0, 7.0)
    for n in range(LANES, order + 1, LANES):
        value = product(at, table + n, rows, s, C, idle)
        store(p, n, value)
        bend = fused(absolute(value), weight, bend)
        weight = add(weight, splat(4.0))
    return total(bend)


@njit(inline="always", **COMPILED)
def _enter(places, which, direction, s, digits, N):
    """Changes the digit of an element and sets what the new mode sets; returns old digit, new digit, speed."""
    old = read_integer(digits, which)
    new = old + direction
    write_integer(digits, which, new)
    speed = 0.0
    for j in range(N):
        speed += read(places.speed_row, which * N + j) * read(s, j)
    slot = read_integer(places.reset_slot, which)
    if read_integer(places.kind, which) == FRICTION:
        if new == read_integer(places.stick, which):
            write(s, slot, 0.0)
    elif slot >= 0 and new != 1:
        row = (3 * which + new) * (N + 1)
        value = read(places.reset_row, row + N)
        for j in range(N):
            value += read(places.reset_row, row + j) * read(s, j)
        write(s, slot, value)
    return old, new, speed


@njit(inline="always", **COMPILED)
def _next_event(at, s, series, order, stride, length, time, N, C, E, idle):
    """First crossing of any guard within `time` (in samples): its time in sub-steps, element (−1: none), direction.

    The Taylor series is made only of guards that may leave their bounds.
    """
    first = time / length
    which = -1
    direction = 0
    wide = padded(E)
    height = padded(N) + ELEMENT_ROWS * wide
    bounds = C * height
    taylor = bounds + 2 * wide + HEADER + stride * C * padded(N)
    rows = padded(stride + 1)
    for e in range(0, wide, LANES):
        guard = padded(N) + e
        g, d, swing = guards_of(at, guard, wide, height, s, C, idle)
        # What the guard's sum may be wrong by; a bound is a number of the same size.
        sizes = add(absolute_product(at, guard, height, s, C, idle), add(absolute(d), swing))
        tolerances = multiply(sizes, splat(4.5e-16))
        low, high = load(at, bounds + e), load(at, bounds + wide + e)
        end, sway = fused(d, splat(time), g), multiply(swing, splat(time * time))
        below = less(add(g, tolerances), low) | less(subtract(end, sway), low)
        above = less(high, subtract(g, tolerances)) | less(high, add(end, sway))
        if below | above == 0:
            continue
        store(series, 0, tolerances)
        p = series + 8 * LANES
        for i in range(LANES):
            if ((below | above) >> i) & 1 == 0:
                continue
            table = taylor + (e + i) * C * rows
            bend = _expand(at, table, rows, s, p, order, C, idle)
            tolerance = read(series, i)
            if (below >> i) & 1:
                found = first_crossing(p, order, 1.0, read(at, bounds + e + i), first, bend, tolerance)
                if found <= first:
                    first, which, direction = found, e + i, -1
            if (above >> i) & 1:
                found = first_crossing(
                    p, order, -1.0, read(at, bounds + wide + e + i), first, bend, tolerance
                )
                if found <= first:
                    first, which, direction = found, e + i, 1
    return first, which, direction


@njit(forceinline=True, **INNER)
def copy_state(s, to, N):
    """to[:N] = s[:N]."""
    whole = N & -LANES
    for i in range(0, whole, LANES):
        store(to, i, load(s, i))
    for i in range(whole, N):
        write(to, i, read(s, i))


@njit(forceinline=True, **INNER)
def add_change(s, change, N):
    """s[:N] += change[:N], by fours where that leaves the inputs alone."""
    whole = N & -LANES
    for i in range(0, whole, LANES):
        store(s, i, add(load(s, i), load(change, i)))
    for i in range(whole, N):
        write(s, i, read(s, i) + read(change, i))


@njit(inline="always", **COMPILED)
def _advance(at, table, s, change, order, time, N, C, idle):
    """Takes the state `time` (in sub-steps) on by its Taylor series, whose table starts at at[table]."""
    high = padded(N)
    row = C * high
    t, square = splat(time), splat(time * time)
    for i in range(0, high, LANES):
        # Even and odd orders apart: half the waiting.
        even, odd = splat(0.0), splat(0.0)
        n = order - 1
        if order % 2:
            odd = product(at, table + n * row + i, high, s, C, idle)
            n -= 1
        while n > 0:
            even = fused(even, square, product(at, table + n * row + i, high, s, C, idle))
            odd = fused(odd, square, product(at, table + (n - 1) * row + i, high, s, C, idle))
            n -= 2
        store(change, i, multiply(t, fused(even, t, odd)))
    add_change(s, change, N)


@njit(**INNER)
def finish_sample(places, s, digits, start, k, events, space, count, N, C, E, idle):
    """The rest of sample k from time `start` (in samples), event by event; returns status, time reached, event count.

    places, and the addresses of s, digits, events: see `places_of`. space: rows of events.
    """
    t = start
    in_sample = 0
    change, stride = places.work, places.order
    series = change + 8 * padded(N)
    size = block_size(N, C, E, stride)
    header = C * (padded(N) + ELEMENT_ROWS * padded(E)) + 2 * padded(E)
    mode = 0
    for e in range(E):
        mode += read_integer(digits, e) * read_integer(places.radix, e)
    status = NEED_MODE
    while True:
        m = read_integer(places.row, mode)
        if m < 0:
            break
        if t >= 1.0:
            status = DONE
            break
        at = places.flat + 8 * m * size
        length = read(at, header)
        order = int(read(at, header + 1))
        whole = 1.0 - t <= length
        time = 1.0 - t if whole else length
        first, which, direction = _next_event(at, s, series, order, stride, length, time, N, C, E, idle)
        if which >= 0 and count == space:
            status = NEED_EVENT_SPACE
            break
        if first > 0.0:
            _advance(at, header + HEADER, s, change, order, first, N, C, idle)
        if which < 0:
            t = 1.0 if whole else t + length
            continue
        t += first * length
        in_sample += 1
        if in_sample > MAX_EVENTS_PER_SAMPLE:
            status = CHATTERING
            break
        old, new, speed = _enter(places, which, direction, s, digits, N)
        mode += direction * read_integer(places.radix, which)
        event = events + 8 * count * (EVENT_COLUMNS + N)
        write(event, 0, k + t)
        write(event, 1, float(which))
        write(event, 2, float(old))
        write(event, 3, float(new))
        write(event, 4, speed)
        write(event, 5, float(mode))
        copy_state(s, event + 8 * EVENT_COLUMNS, N)
        count += 1
    return status, t, count

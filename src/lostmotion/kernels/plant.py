"""Exact event-driven simulation of a piecewise-linear plant: from event to event, no step size, no tolerance.

The plant is a set of *modes*, each a linear system with constant inputs and a constant term. With
s = [x, v, 1] (N states, M held inputs, one; C numbers in all), a mode gives

- delta @ s        the change of x over one whole sample (exact),

and for each element e (a shaft with backlash, or a friction)

- guard @ s        its guard function, which must stay within [lower, upper] while the mode lasts,
- guard_rate @ s   T · d(guard)/dt,
- swing @ |s|      T²/2 · max |second derivative of guard| over the sample,
- remainder @ |s|  T⁴/384 · max |fourth derivative of guard|, the error of the cubic Hermite interpolation,

and the Taylor series of all guards and of the state over one *piece*, a time that is short against the mode's fastest
pole. ``flat`` holds one block of numbers per mode, which Plant in ``simulation.tables`` fills. Tables lie column by
column, since four rows at a time are a column's four numbers times one number of s; counts of rows are rounded up to
whole groups of four (N₄, E₄, (O + 1)₄), the rest being zero, and −∞, ∞ for bounds. O is the order of the table that
needs most:

    for each column of s    N₄ of delta, E₄ of guard, E₄ of guard_rate, E₄ of swing, E₄ of remainder
    E₄ lower bounds, E₄ upper bounds
    length of a piece in samples, order of this mode's own series, 0, 0
    for order 1 … O         for each column of s   N₄ of the state's coefficients
    for each element        for each column of s   (O + 1)₄ of the guard's coefficients, order 0 … O

Every element has one *digit*; its order is along the axis of its guard, so that leaving by the lower bound lowers the
digit by one and leaving by the upper bound raises it by one (shaft: −, gap, +; friction: negative segments, stick,
positive segments). The mode is the number made of all digits.

A sample in which the enclosure excludes every crossing is one matrix product. Otherwise the guards that may cross are
expanded in their Taylor series (converged to rounding), the first crossing is found on that polynomial by steps that
can be shown never to jump over a root, and the rest of the sample goes on from there in the next mode.

Two habits make it fast: four rows go through one register, and arrays are read by address (``vectors``), without tests
of the index and without numba's counting of references.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .vectors import (
    LANES,
    absolute,
    add,
    address,
    fused,
    larger,
    less,
    load,
    multiply,
    pack,
    read,
    read_integer,
    smaller,
    splat,
    spread,
    store,
    subtract,
    total,
    write,
    write_integer,
)

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

DONE, NEED_MODE, NEED_EVENT_SPACE, CHATTERING = 0, 1, 2, 3
SHAFT, FRICTION, BRANCH = 0, 1, 2
#: Events within one sample beyond which the run is given up as chattering (chosen).
MAX_EVENTS_PER_SAMPLE = 10_000
#: Smallest step of the root search as a fraction of a piece: a few units of rounding of the time itself.
SMALLEST_STEP = 2.0**-50
#: An event's row: time in samples, element, old digit, new digit, speed at the element, new mode; then the state.
EVENT_COLUMNS = 6
#: Highest order of the Taylor series that the tables may ask for.
MAX_ORDER = 24
#: Rows of each element in a mode's block.
ELEMENT_ROWS = 4
#: Numbers between a mode's bounds and its series: length of a piece, order.
HEADER = 4
#: Bits of four guards that all stay within their bounds.
ALL = 2**LANES - 1
#: Rows of a two-mass plant's columns: four of the state, four groups of guards.
TWO_MASS_ROWS = 20


class PlantTables(NamedTuple):
    """All modes of a plant, see the module's description."""

    flat: Array  # one block for each row
    row: Indices  # (modes,): row of each mode, −1 while it was never entered
    radix: Indices  # (E,): weight of each element's digit in the mode's number
    kind: Indices  # (E,): SHAFT, FRICTION, or BRANCH of a contact law
    stick: Indices  # (E,): digit of rest, −1 for all but frictions
    speed_row: Array  # (E, N): the speed that is reported with an event
    reset_row: Array  # (E, 3, N + 1): for a shaft's digit 0, 1, 2: the value set on entering, see reset_slot
    reset_slot: Indices  # (E,): state that is set on entering a mode (rest: speed; physical law: shaft angle)
    order: int  # O, of the Taylor series
    idle: int  # column of s that no rate and no guard depends on: the motor angle


def new_work(states: int) -> Array:
    """Scratch of the kernels: change of the state, tolerances of four guards, Taylor series of one."""
    return np.zeros(states + 3 * LANES + MAX_ORDER + 1 + LANES)


class Places(NamedTuple):
    """Addresses of the arrays that events read: handed on as arrays, their counted references would cost more."""

    flat: int
    row: int
    radix: int
    kind: int
    stick: int
    speed_row: int
    reset_row: int
    reset_slot: int
    work: int
    order: int


# forceinline: typed once, which halves the compiling; inline="always" where a caller's sizes must reach the loops.
_PLANT: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy"}
#: Of what only kernels call (a call from Python would crash): wrappers for Python cost compile time.
_INNER: Any = {**_PLANT, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


@njit(forceinline=True, **_INNER)
def padded(count):
    """Numbers that hold `count` rows in whole groups of LANES."""
    return (count + LANES - 1) & -LANES


@njit(forceinline=True, **_INNER)
def block_size(N, C, E, order):
    """Numbers in one mode's block; Python calls ``block_size.py_func``, so it calls no other kernel."""
    high, wide, long = (N + LANES - 1) & -LANES, (E + LANES - 1) & -LANES, (order + LANES) & -LANES
    return C * (high + ELEMENT_ROWS * wide) + 2 * wide + HEADER + order * C * high + E * C * long


@njit(inline="always", **_PLANT)
def places_of(tb, work):
    """Addresses of the tables and of the scratch; the caller keeps both."""
    return Places(
        address(tb.flat), address(tb.row), address(tb.radix), address(tb.kind), address(tb.stick),
        address(tb.speed_row), address(tb.reset_row), address(tb.reset_slot), address(work), tb.order,
    )  # fmt: skip


@njit(inline="always", **_PLANT)
def mode_number(radix, digits, E):
    mode = 0
    for e in range(E):
        mode += digits[e] * radix[e]
    return mode


@njit(inline="always", **_PLANT)
def _product(at, table, height, s, C, idle):
    """Four rows at at[table], columns `height` apart, times s; the idle column is left out."""
    rows = load(at, table + (C - 1) * height)
    for j in range(idle):
        rows = fused(load(at, table + j * height), splat(read(s, j)), rows)
    for j in range(idle + 1, C - 1):
        rows = fused(load(at, table + j * height), splat(read(s, j)), rows)
    return rows


@njit(inline="always", **_PLANT)
def _sizes(at, table, height, s, C, idle):
    """Four rows as in `_product`, of absolute values, times |s|."""
    rows = absolute(load(at, table + (C - 1) * height))
    for j in range(idle):
        rows = fused(absolute(load(at, table + j * height)), splat(abs(read(s, j))), rows)
    for j in range(idle + 1, C - 1):
        rows = fused(absolute(load(at, table + j * height)), splat(abs(read(s, j))), rows)
    return rows


@njit(inline="always", **_PLANT)
def _two_products(at, table, height, s, C, idle):
    """The four rows at at[table] and the next four times s, at once: neither waits for the other."""
    last = table + (C - 1) * height
    first, second = load(at, last), load(at, last + LANES)
    for j in range(C - 1):
        if j != idle:
            value, column = splat(read(s, j)), table + j * height
            first = fused(load(at, column), value, first)
            second = fused(load(at, column + LANES), value, second)
    return first, second


@njit(inline="always", **_PLANT)
def _guards(at, table, wide, height, s, C, idle):
    """Four guards whose rows begin at at[table], their rates and swings, at once."""
    last = table + (C - 1) * height
    g, d, swing = load(at, last), load(at, last + wide), load(at, last + 2 * wide)
    for j in range(C - 1):
        if j != idle:
            value, column = splat(read(s, j)), table + j * height
            g = fused(load(at, column), value, g)
            d = fused(load(at, column + wide), value, d)
            swing = fused(load(at, column + 2 * wide), absolute(value), swing)
    return g, d, swing


@njit(forceinline=True, **_INNER)
def _within(low, g, d, swing, high):
    """Bits of the guards that stay within their bounds: g + d·t ∓ swing·t² is extreme at an end."""
    end = add(g, d)
    inside = less(low, g) & less(g, high)
    return inside & less(low, subtract(end, swing)) & less(add(end, swing), high)


@njit(inline="always", **_PLANT)
def _quiet(at, s, change, N, C, E, idle):
    """True if no guard can leave its bounds in the whole sample; `change` becomes the state's change over it."""
    wide = padded(E)
    height = padded(N) + ELEMENT_ROWS * wide
    pairs = padded(N) & -2 * LANES
    for i in range(0, pairs, 2 * LANES):
        first, second = _two_products(at, i, height, s, C, idle)
        store(change, i, first)
        store(change, i + LANES, second)
    for i in range(pairs, padded(N), LANES):
        store(change, i, _product(at, i, height, s, C, idle))
    bounds = C * height
    for e in range(0, wide, LANES):
        guard = padded(N) + e
        g0, d0, swing = _guards(at, guard, wide, height, s, C, idle)
        low, high = load(at, bounds + e), load(at, bounds + wide + e)
        inside = _within(low, g0, d0, swing, high)
        if inside == ALL:
            continue
        # Cubic Hermite through both ends: it lies between its Bernstein points; the remainder bounds its error.
        g1, d1 = g0, d0
        for j in range(N):
            step = splat(read(change, j))
            g1 = fused(load(at, guard + j * height), step, g1)
            d1 = fused(load(at, guard + wide + j * height), step, d1)
        b1, b2 = fused(d0, splat(1.0 / 3.0), g0), fused(d1, splat(-1.0 / 3.0), g1)
        remainder = _sizes(at, guard + 3 * wide, height, s, C, idle)
        lowest = subtract(smaller(smaller(g0, g1), smaller(b1, b2)), remainder)
        highest = add(larger(larger(g0, g1), larger(b1, b2)), remainder)
        if inside | (less(low, lowest) & less(highest, high)) != ALL:
            return False
    return True


@njit(forceinline=True, **_INNER)
def _evaluate(p, order, t):
    """Polynomial with coefficients p at t: its Taylor coefficients of order 0 to 3 there."""
    q = read(p, order)
    q1 = 0.0
    q2 = 0.0
    q3 = 0.0
    for k in range(order - 1, -1, -1):
        q3 = q3 * t + q2
        q2 = q2 * t + q1
        q1 = q1 * t + q
        q = q * t + read(p, k)
    return q, q1, q2, q3


@njit(forceinline=True, **_INNER)
def _reversed(q, q1, q2, q3):
    """Root of q + q1·t + q2·t² + q3·t³ by the reversed series up to order three, and what its last term does to q."""
    inverse = 1.0 / q1
    u = -q * inverse
    a = q2 * inverse
    last = u * u * u * (2.0 * a * a - q3 * inverse)
    return u - a * u * u + last, abs(q1 * last)


@njit(forceinline=True, **_INNER)
def _only_crossing(p, order, sign, bound, until, tolerance):
    """The root of a monotone polynomial: by reversed series, by halves where those lead out of the bracket."""
    t, _ = _reversed(read(p, 0) - bound, read(p, 1), read(p, 2), read(p, 3))
    low, high = 0.0, until
    for _ in range(100):
        if not low <= t <= high:
            t = 0.5 * (low + high)
        q, q1, q2, q3 = _evaluate(p, order, t)
        q -= bound
        step, last = _reversed(q, q1, q2, q3)
        if sign * q > 0.0:
            low = t
        else:
            high = t
        t += step
        if last <= tolerance:
            break
    return min(max(t, 0.0), until)


@njit(**_INNER)
def _stepped_crossing(p, order, sign, bound, until, tolerance):
    """As `_first_crossing`: each step ends before the first root of a quadratic that lies below q."""
    third = 0.0  # bounds the third derivative
    for k in range(3, order + 1):
        third += k * (k - 1.0) * (k - 2.0) * abs(read(p, k))
    t = 0.0
    smallest = SMALLEST_STEP
    while True:
        q, q1, q2, _ = _evaluate(p, order, t)
        q = sign * (q - bound)
        q1 *= sign
        q2 *= 2.0 * sign
        if q < -tolerance:
            return t
        left = until - t
        if left <= 0.0:
            return 2.0
        curvature = q2 - third * left
        if curvature >= 0.0 and q1 >= 0.0:
            return 2.0
        q = max(q, 0.0)
        square = q1 * q1 - 2.0 * curvature * q
        if square < 0.0:
            return 2.0
        if q1 < 0.0:
            step = 2.0 * q / (-q1 + np.sqrt(square))
        else:
            step = (q1 + np.sqrt(square)) / -curvature
        if step >= left:
            # The bound holds up to the end; the end itself may lie on the wrong side by rounding only.
            return 2.0
        if step < smallest:
            step = smallest
            smallest *= 2.0
        t += step


@njit(forceinline=True, **_INNER)
def _first_crossing(p, order, sign, bound, until, bend, tolerance):
    """First time in [0, until] at which q = sign·(p − bound) goes below zero; 2.0 if it does not.

    p: address of the polynomial's coefficients on the normalised piece [0, 1]; bend: bounds how much the slope
    changes there; tolerance: rounding of q. A monotone q has one root at most; otherwise the steps jump over none.
    """
    q = sign * (read(p, 0) - bound)
    slope = sign * read(p, 1)
    change = bend * until
    if q < -tolerance or abs(slope) <= change:
        return _stepped_crossing(p, order, sign, bound, until, tolerance)
    if slope > 0.0:
        return 2.0
    if q + (slope + change) * until >= -tolerance:
        end, _, _, _ = _evaluate(p, order, until)
        if sign * (end - bound) >= -tolerance:
            return 2.0
    return _only_crossing(p, order, sign, bound, until, tolerance)


@njit(inline="always", **_PLANT)
def _expand(at, table, rows, s, p, order, C, idle):
    """Taylor series of the guard whose table starts at at[table], to p; returns what bounds the change of its slope."""
    first = _product(at, table, rows, s, C, idle)
    store(p, 0, first)
    weight = pack(0.0, 0.0, 2.0, 3.0)
    bend = multiply(absolute(first), weight)
    weight = pack(4.0, 5.0, 6.0, 7.0)
    for n in range(LANES, order + 1, LANES):
        value = _product(at, table + n, rows, s, C, idle)
        store(p, n, value)
        bend = fused(absolute(value), weight, bend)
        weight = add(weight, splat(4.0))
    return total(bend)


@njit(inline="always", **_PLANT)
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


@njit(inline="always", **_PLANT)
def _next_event(at, s, series, order, stride, length, time, N, C, E, idle):
    """First crossing of any guard within `time` (in samples): its time in pieces, element (−1: none), direction.

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
        g, d, swing = _guards(at, guard, wide, height, s, C, idle)
        # What the guard's sum may be wrong by; a bound is a number of the same size.
        sizes = add(_sizes(at, guard, height, s, C, idle), add(absolute(d), swing))
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
                found = _first_crossing(p, order, 1.0, read(at, bounds + e + i), first, bend, tolerance)
                if found <= first:
                    first, which, direction = found, e + i, -1
            if (above >> i) & 1:
                found = _first_crossing(
                    p, order, -1.0, read(at, bounds + wide + e + i), first, bend, tolerance
                )
                if found <= first:
                    first, which, direction = found, e + i, 1
    return first, which, direction


@njit(forceinline=True, **_INNER)
def _copy(s, to, N):
    """to[:N] = s[:N]."""
    whole = N & -LANES
    for i in range(0, whole, LANES):
        store(to, i, load(s, i))
    for i in range(whole, N):
        write(to, i, read(s, i))


@njit(forceinline=True, **_INNER)
def _add_change(s, change, N):
    """s[:N] += change[:N], by fours where that leaves the inputs alone."""
    whole = N & -LANES
    for i in range(0, whole, LANES):
        store(s, i, add(load(s, i), load(change, i)))
    for i in range(whole, N):
        write(s, i, read(s, i) + read(change, i))


@njit(inline="always", **_PLANT)
def _advance(at, table, s, change, order, time, N, C, idle):
    """Takes the state `time` (in pieces) on by its Taylor series, whose table starts at at[table]."""
    high = padded(N)
    row = C * high
    t, square = splat(time), splat(time * time)
    for i in range(0, high, LANES):
        # Even and odd orders apart: half the waiting.
        even, odd = splat(0.0), splat(0.0)
        n = order - 1
        if order % 2:
            odd = _product(at, table + n * row + i, high, s, C, idle)
            n -= 1
        while n > 0:
            even = fused(even, square, _product(at, table + n * row + i, high, s, C, idle))
            odd = fused(odd, square, _product(at, table + (n - 1) * row + i, high, s, C, idle))
            n -= 2
        store(change, i, multiply(t, fused(even, t, odd)))
    _add_change(s, change, N)


@njit(inline="always", **_PLANT)
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
        _copy(s, event + 8 * EVENT_COLUMNS, N)
        count += 1
    return status, t, count


@njit(**_PLANT)
def run_open_loop(tb, s, digits, inputs, work, states, modes, events, cursor):
    """Any plant with torques given: fills states (n + 1, N) and modes (n + 1,); returns a status.

    Parameters
    ----------
    s : (C,) array
        [x, v, 1], changed in place.  digits : (E,) int64, changed in place.
    inputs : (n, M) array
    work : (W,) array
        See `new_work`.
    events : (space, EVENT_COLUMNS + N) array
    cursor : (4,) array
        Where to go on after NEED_MODE or NEED_EVENT_SPACE: sample, time within it (in samples), events so far, and 1
        if the sample was begun.
    """
    E = digits.size
    M = inputs.shape[1]
    C = s.size
    N = C - M - 1
    row, radix = tb.row, tb.radix
    places, idle = places_of(tb, work), tb.idle
    base, x, change = places.flat, address(s), address(work)
    size = block_size(N, C, E, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    status = DONE
    mode = mode_number(radix, digits, E)
    while k < inputs.shape[0]:
        m = row[mode]
        if m < 0:
            status = NEED_MODE
            break
        quiet = False
        if not begun:
            for j in range(M):
                write(x, N + j, inputs[k, j])
            _copy(x, address(states) + 8 * k * N, N)
            modes[k] = mode
            quiet = _quiet(base + 8 * m * size, x, change, N, C, E, idle)
        if quiet:
            _add_change(x, change, N)
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
    cursor[0], cursor[1], cursor[2], cursor[3] = k, start, count, begun
    if status == DONE:
        _copy(x, address(states) + 8 * k * N, N)
        modes[k] = mode
    return status


@njit(forceinline=True, **_INNER)
def _four_rows(at, table, x0, x1, x2, v):
    """Four rows of the two-mass plant times its state and torque; in this order the sum waits least for the state."""
    rest = fused(load(at, table + 4 * TWO_MASS_ROWS), v, load(at, table + 5 * TWO_MASS_ROWS))
    late = fused(load(at, table + TWO_MASS_ROWS), x1, multiply(load(at, table + 2 * TWO_MASS_ROWS), x2))
    return add(fused(load(at, table), x0, rest), late)


@njit(**_PLANT)
def run_open_loop_two_mass(tb, s, digits, inputs, work, states, modes, events, cursor):
    """`run_open_loop` for four states, one input, two elements, with the state in registers (half the time)."""
    row, radix = tb.row, tb.radix
    places = places_of(tb, work)
    base, address_s, change, rows = places.flat, address(s), address(work), address(states)
    size = block_size(4, 6, 2, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    status = DONE
    mode = mode_number(radix, digits, 2)
    m = row[mode]
    at = base + 8 * m * size
    x = load(address_s, 0)
    while k < inputs.shape[0]:
        if m >= 0 and not begun:
            store(rows, 4 * k, x)
            modes[k] = mode
            x0, x1, x2, v = spread(x, 0), spread(x, 1), spread(x, 2), splat(inputs[k, 0])
            g = _four_rows(at, 4, x0, x1, x2, v)
            d = _four_rows(at, 8, x0, x1, x2, v)
            swing = _four_rows(at, 12, absolute(x0), absolute(x1), absolute(x2), absolute(v))
            low, high = load(at, 6 * TWO_MASS_ROWS), load(at, 6 * TWO_MASS_ROWS + 4)
            if _within(low, g, d, swing, high) == ALL:
                x = add(x, _four_rows(at, 0, x0, x1, x2, v))
                k += 1
                continue
        if m < 0:
            status = NEED_MODE
            break
        if not begun:
            store(address_s, 0, x)
            s[4] = inputs[k, 0]
        if not begun and _quiet(at, address_s, change, 4, 6, 2, 3):
            x = add(x, load(change, 0))
        else:
            status, start, count = finish_sample(
                places,
                address_s,
                address(digits),
                start,
                k,
                address(events),
                events.shape[0],
                count,
                4,
                6,
                2,
                3,
            )
            mode = mode_number(radix, digits, 2)
            m = row[mode]
            at = base + 8 * m * size
            if status != DONE:
                begun = True
                break
            start, begun = 0.0, False
            x = load(address_s, 0)
        k += 1
    cursor[0], cursor[1], cursor[2], cursor[3] = k, start, count, begun
    if status == DONE or not begun:
        store(address_s, 0, x)
    if status == DONE:
        store(rows, 4 * k, x)
        modes[k] = mode
    return status


@njit(**_PLANT)
def limit_rate(values, step, last):
    """Set-points that follow `values` by at most `step` from sample to sample, from `last` on."""
    limited = np.empty(values.size)
    for k in range(values.size):
        last = min(max(values[k], last - step), last + step)
        limited[k] = last
    return limited

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
pole. ``flat`` holds one block of numbers per mode, which Plant in ``simulation.tables`` fills:

    N rows of delta                                                 (C numbers each)
    for each element guard, guard_rate, swing, remainder            (C numbers each)
    for each element lower, upper
    length of a piece in samples
    for each column of s: E guards' coefficients of order 0 … O, then the state's of order 1 … O, N for each order

Every element has one *digit*; its order is along the axis of its guard, so that leaving by the lower bound lowers the
digit by one and leaving by the upper bound raises it by one (shaft: −, gap, +; friction: negative segments, stick,
positive segments). The mode is the number made of all digits.

A sample in which the enclosure excludes every crossing is one matrix product. Otherwise the guards are expanded
in their Taylor series (converged to rounding), the first crossing is found on that polynomial by steps that can be
shown never to jump over a root, and the rest of the sample goes on from there in the next mode.

Two habits make it fast: arrays are taken out of their tuples once per run, since numba counts references each time;
and table entries are addressed by unsigned numbers, which cannot be negative and need no test for it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit, uint64
from numpy.typing import NDArray

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


class Work(NamedTuple):
    """Scratch of the kernels: change of the state, Taylor coefficients."""

    change: Array  # (N,)
    series: Array  # (E (O + 1) + O N,)


def new_work(states: int, elements: int) -> Work:
    return Work(np.zeros(states), np.zeros(elements * (MAX_ORDER + 1) + MAX_ORDER * states))


_PLANT: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy"}


@njit(inline="always", **_PLANT)
def block_size(N, C, E, order):
    """Numbers in one mode's block."""
    return (N + ELEMENT_ROWS * E) * C + 2 * E + 1 + C * (E * (order + 1) + order * N)


@njit(inline="always", **_PLANT)
def mode_number(radix, digits, E):
    mode = 0
    for e in range(E):
        mode += digits[e] * radix[e]
    return mode


@njit(inline="always", **_PLANT)
def _dot(flat, at, s, C):
    total = 0.0
    for j in range(C):
        total += flat[at + uint64(j)] * s[j]
    return total


@njit(inline="always", **_PLANT)
def _quiet(flat, at, s, change, N, C, E):
    """True if no guard can leave its bounds in the whole sample; `change` becomes the state's change over it."""
    for i in range(N):
        change[i] = _dot(flat, at + uint64(i * C), s, C)
    bounds = at + uint64((N + ELEMENT_ROWS * E) * C)
    for e in range(E):
        guard = at + uint64((N + ELEMENT_ROWS * e) * C)
        rate, swings = guard + uint64(C), guard + uint64(2 * C)
        low, high = flat[bounds + uint64(2 * e)], flat[bounds + uint64(2 * e + 1)]
        g0 = 0.0
        d0 = 0.0
        swing = 0.0
        for j in range(C):
            g0 += flat[guard + uint64(j)] * s[j]
            d0 += flat[rate + uint64(j)] * s[j]
            swing += flat[swings + uint64(j)] * abs(s[j])
        if g0 + min(d0, 0.0) - swing > low and g0 + max(d0, 0.0) + swing < high:
            continue
        # Cubic Hermite through both ends: it lies between its Bernstein points; the remainder bounds its error.
        g1 = g0
        d1 = d0
        for j in range(N):
            g1 += flat[guard + uint64(j)] * change[j]
            d1 += flat[rate + uint64(j)] * change[j]
        remainders = guard + uint64(3 * C)
        remainder = 0.0
        for j in range(C):
            remainder += flat[remainders + uint64(j)] * abs(s[j])
        b1 = g0 + d0 / 3.0
        b2 = g1 - d1 / 3.0
        if not (
            min(min(g0, g1), min(b1, b2)) - remainder > low
            and max(max(g0, g1), max(b1, b2)) + remainder < high
        ):
            return False
    return True


@njit(inline="always", **_PLANT)
def _dot_two_mass(flat, at, x0, x1, x2, v):
    """A row of the two-mass plant without its motor angle; in this order the sum waits least for the state."""
    rest = flat[at + uint64(5)] + flat[at + uint64(4)] * v
    return (rest + flat[at] * x0) + (flat[at + uint64(1)] * x1 + flat[at + uint64(2)] * x2)


@njit(inline="always", **_PLANT)
def _far_two_mass(flat, guard, bounds, x0, x1, x2, v, a0, a1, a2, a):
    """The enclosure's first test for one guard of the two-mass plant; a…: absolute values."""
    g0 = _dot_two_mass(flat, guard, x0, x1, x2, v)
    d0 = _dot_two_mass(flat, guard + uint64(6), x0, x1, x2, v)
    swing = _dot_two_mass(flat, guard + uint64(12), a0, a1, a2, a)
    return (g0 + min(d0, 0.0) - swing > flat[bounds]) & (g0 + max(d0, 0.0) + swing < flat[bounds + uint64(1)])


@njit(inline="always", **_PLANT)
def _evaluate(p, c, top, t):
    """Polynomial of order `top` with coefficients p[c:] at t: value, first derivative, half the second."""
    q = p[c + uint64(top)]
    q1 = 0.0
    q2 = 0.0
    for k in range(top - 1, -1, -1):
        q2 = q2 * t + q1
        q1 = q1 * t + q
        q = q * t + p[c + uint64(k)]
    return q, q1, q2


@njit(inline="always", **_PLANT)
def _step(q, q1, q2):
    """Nearest root of q + q1·t + q2·t², of the tangent if there is none."""
    root = q1 * q1 - 4.0 * q2 * q
    return 2.0 * q / (-q1 + np.sqrt(root)) if root > 0.0 else -q / q1


@njit(**_PLANT)
def _only_crossing(p, c, order, sign, bound, until, third, tolerance):
    """Root of a falling polynomial that crosses its bound: steps on quadratics, until the cubic term is rounding."""
    t = min(max(_step(sign * (p[c] - bound), sign * p[c + uint64(1)], sign * p[c + uint64(2)]), 0.0), until)
    top = 3
    for _ in range(40):
        q, q1, q2 = _evaluate(p, c, top, t)
        q = sign * (q - bound)
        if top == order and abs(q) <= tolerance:
            break
        step = _step(q, sign * q1, sign * q2)
        t = min(max(t + step, 0.0), until)
        if top == order and third * abs(step * step * step) <= tolerance:
            break
        top = order
    return t


@njit(**_PLANT)
def _first_crossing(p, start, order, sign, bound, until, tolerance):
    """First time in [0, until] at which q = sign·(p − bound) goes below zero; 2.0 if it does not.

    p holds polynomial coefficients from `start` on, on the normalised piece [0, 1]; tolerance: rounding of q. A
    monotone q has one root at most. Otherwise each step ends before the first root of a quadratic that lies below q,
    so that no root is jumped over.
    """
    c = uint64(start)
    bend = 2.0 * abs(p[c + uint64(2)])  # bounds |q' − q'(0)|
    third = 0.0  # bounds |q'''|
    weight = 2.0
    for k in range(3, order + 1):
        weight += 1.0
        term = weight * abs(p[c + uint64(k)])
        bend += term
        third += (weight - 1.0) * (weight - 2.0) * term
    q0 = sign * (p[c] - bound)
    if q0 >= -tolerance:
        slope = sign * p[c + uint64(1)]
        if slope > bend * until:
            return 2.0
        if -slope > bend * until:
            q, _, _ = _evaluate(p, c, order, until)
            if sign * (q - bound) >= -tolerance:
                return 2.0
            return _only_crossing(p, c, order, sign, bound, until, third, tolerance)
    t = 0.0
    smallest = SMALLEST_STEP
    while True:
        q, q1, q2 = _evaluate(p, c, order, t)
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


@njit(inline="always", **_PLANT)
def _expand(flat, at, first, stop, width, s, C, idle, series):
    """Taylor coefficients number `first` to `stop` out of the mode's table, which holds `width` for each column.

    Three columns in each pass over the coefficients; the first pass brings in the constant one as well.
    """
    constant = at + uint64((C - 1) * width)
    a = s[0] if idle != 0 else 0.0
    b = s[1] if idle != 1 else 0.0
    c = s[2] if idle != 2 else 0.0
    at_b = at + uint64(width)
    at_c = at_b + uint64(width)
    for v in range(first, stop):
        n = uint64(v)
        series[v] = (flat[constant + n] + flat[at + n] * a) + (flat[at_b + n] * b + flat[at_c + n] * c)
    j = 3
    while j < C - 1:
        if j + 2 < C - 1:
            a = s[j] if j != idle else 0.0
            b = s[j + 1] if j + 1 != idle else 0.0
            c = s[j + 2] if j + 2 != idle else 0.0
            at_a = at + uint64(j * width)
            at_b = at_a + uint64(width)
            at_c = at_b + uint64(width)
            for v in range(first, stop):
                n = uint64(v)
                series[v] += flat[at_a + n] * a + (flat[at_b + n] * b + flat[at_c + n] * c)
            j += 3
            continue
        if j != idle:
            a = s[j]
            at_a = at + uint64(j * width)
            for v in range(first, stop):
                series[v] += flat[at_a + uint64(v)] * a
        j += 1


@njit(inline="always", **_PLANT)
def _enter(which, direction, s, digits, kind, stick, speed_row, reset_row, reset_slot, N):
    """Changes the digit of an element and sets what the new mode sets; returns old digit, new digit, speed."""
    old = digits[which]
    new = old + direction
    digits[which] = new
    speed = 0.0
    for j in range(N):
        speed += speed_row[which, j] * s[j]
    slot = reset_slot[which]
    if kind[which] == FRICTION:
        if new == stick[which]:
            s[slot] = 0.0
    elif slot >= 0 and new != 1:
        total = reset_row[which, new, N]
        for j in range(N):
            total += reset_row[which, new, j] * s[j]
        s[slot] = total
    return old, new, speed


@njit(inline="always", **_PLANT)
def _next_event(flat, rows, bounds, s, series, order, until, C, E):
    """First crossing of any guard within `until`: its time, element (−1: none), direction."""
    first = until
    which = -1
    direction = 0
    for e in range(E):
        c = uint64(e * (order + 1))
        spread = 0.0
        for n in range(1, order + 1):
            spread += abs(series[c + uint64(n)])
        lower, upper = flat[bounds + uint64(2 * e)], flat[bounds + uint64(2 * e + 1)]
        # What the guard's sum may be wrong by; a bound is a number of the same size.
        terms = 0.0
        guard = rows + uint64(ELEMENT_ROWS * e * C)
        for j in range(C):
            terms += abs(flat[guard + uint64(j)] * s[j])
        tolerance = 4.5e-16 * (spread + terms)
        start = series[c]
        reach = spread * first + tolerance
        if start - reach <= lower:
            found = _first_crossing(series, c, order, 1.0, lower, first, tolerance)
            if found <= first:
                first, which, direction = found, e, -1
        if start + reach >= upper:
            found = _first_crossing(series, c, order, -1.0, upper, first, tolerance)
            if found <= first:
                first, which, direction = found, e, 1
    return first, which, direction


@njit(inline="always", **_PLANT)
def finish_sample(
    flat, row, radix, kind, stick, speed_row, reset_row, reset_slot, order, idle, series,
    s, digits, start, k, events, count, N, C, E,
):  # fmt: skip
    """The rest of sample k from time `start` (in samples), event by event; returns status, time reached, event count.

    The arrays of the tables come one by one: taking them out of a tuple here would cost as much as an event.
    """
    t = start
    in_sample = 0
    guards = E * (order + 1)
    width = guards + order * N
    size = block_size(N, C, E, order)
    status = NEED_MODE
    while True:
        m = row[mode_number(radix, digits, E)]
        if m < 0:
            break
        if t >= 1.0:
            status = DONE
            break
        rows = uint64(m * size + N * C)
        bounds = rows + uint64(ELEMENT_ROWS * E * C)
        taylor = bounds + uint64(2 * E + 1)
        length = flat[bounds + uint64(2 * E)]
        whole = 1.0 - t <= length
        until = (1.0 - t) / length if whole else 1.0
        _expand(flat, taylor, 0, guards, width, s, C, idle, series)
        first, which, direction = _next_event(flat, rows, bounds, s, series, order, until, C, E)
        if which >= 0 and count == events.shape[0]:
            status = NEED_EVENT_SPACE
            break
        if first > 0.0:
            _expand(flat, taylor, guards, width, width, s, C, idle, series)
            for i in range(N):
                total = series[width - N + i]
                for n in range(order - 2, -1, -1):
                    total = total * first + series[guards + n * N + i]
                s[i] += total * first
        if which < 0:
            t = 1.0 if whole else t + length
            continue
        t += first * length
        in_sample += 1
        if in_sample > MAX_EVENTS_PER_SAMPLE:
            status = CHATTERING
            break
        old, new, speed = _enter(
            which, direction, s, digits, kind, stick, speed_row, reset_row, reset_slot, N
        )
        events[count, 0] = k + t
        events[count, 1] = which
        events[count, 2] = old
        events[count, 3] = new
        events[count, 4] = speed
        events[count, 5] = mode_number(radix, digits, E)
        for i in range(N):
            events[count, EVENT_COLUMNS + i] = s[i]
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
    work : Work
    events : (space, EVENT_COLUMNS + N) array
    cursor : (4,) array
        Where to go on after NEED_MODE or NEED_EVENT_SPACE: sample, time within it (in samples), events so far, and 1
        if the sample was begun.
    """
    E = digits.size
    M = inputs.shape[1]
    C = s.size
    N = C - M - 1
    flat, row, radix, change = tb.flat, tb.row, tb.radix, work.change
    kind, stick, speed_row, reset_row, reset_slot = (
        tb.kind,
        tb.stick,
        tb.speed_row,
        tb.reset_row,
        tb.reset_slot,
    )
    order, idle, series = tb.order, tb.idle, work.series
    size = block_size(N, C, E, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    status = DONE
    while k < inputs.shape[0]:
        mode = mode_number(radix, digits, E)
        m = row[mode]
        if m < 0:
            status = NEED_MODE
            break
        quiet = False
        if not begun:
            for j in range(M):
                s[N + j] = inputs[k, j]
            for i in range(N):
                states[k, i] = s[i]
            modes[k] = mode
            quiet = _quiet(flat, uint64(m * size), s, change, N, C, E)
        if quiet:
            for i in range(N):
                s[i] += change[i]
        else:
            status, start, count = finish_sample(
                flat, row, radix, kind, stick, speed_row, reset_row, reset_slot, order, idle, series,
                s, digits, start, k, events, count, N, C, E,
            )  # fmt: skip
            if status != DONE:
                begun = True
                break
            start, begun = 0.0, False
        k += 1
    cursor[0], cursor[1], cursor[2], cursor[3] = k, start, count, begun
    if status == DONE:
        for i in range(N):
            states[k, i] = s[i]
        modes[k] = mode_number(radix, digits, E)
    return status


@njit(**_PLANT)
def run_open_loop_two_mass(tb, s, digits, inputs, work, states, modes, events, cursor):
    """`run_open_loop` for four states, one input, two elements, with the state in registers (a third of the time)."""
    flat, row, radix, change = tb.flat, tb.row, tb.radix, work.change
    kind, stick, speed_row, reset_row, reset_slot = (
        tb.kind,
        tb.stick,
        tb.speed_row,
        tb.reset_row,
        tb.reset_slot,
    )
    order, idle, series = tb.order, tb.idle, work.series
    size = block_size(4, 6, 2, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    status = DONE
    mode = mode_number(radix, digits, 2)
    m = row[mode]
    x0, x1, x2, x3 = s[0], s[1], s[2], s[3]
    while k < inputs.shape[0]:
        v = inputs[k, 0]
        if m >= 0 and not begun:
            states[k, 0] = x0
            states[k, 1] = x1
            states[k, 2] = x2
            states[k, 3] = x3
            modes[k] = mode
            a0, a1, a2, a = abs(x0), abs(x1), abs(x2), abs(v)
            at = uint64(m * size)
            bounds = at + uint64(72)
            if _far_two_mass(flat, at + uint64(24), bounds, x0, x1, x2, v, a0, a1, a2, a) & _far_two_mass(
                flat, at + uint64(48), bounds + uint64(2), x0, x1, x2, v, a0, a1, a2, a
            ):
                d0 = _dot_two_mass(flat, at, x0, x1, x2, v)
                d1 = _dot_two_mass(flat, at + uint64(6), x0, x1, x2, v)
                d2 = _dot_two_mass(flat, at + uint64(12), x0, x1, x2, v)
                d3 = _dot_two_mass(flat, at + uint64(18), x0, x1, x2, v)
                x0 += d0
                x1 += d1
                x2 += d2
                x3 += d3
                k += 1
                continue
        if m < 0:
            status = NEED_MODE
            break
        s[0], s[1], s[2], s[3], s[4] = x0, x1, x2, x3, v
        if not begun and _quiet(flat, uint64(m * size), s, change, 4, 6, 2):
            for i in range(4):
                s[i] += change[i]
        else:
            status, start, count = finish_sample(
                flat, row, radix, kind, stick, speed_row, reset_row, reset_slot, order, idle, series,
                s, digits, start, k, events, count, 4, 6, 2,
            )  # fmt: skip
            mode = mode_number(radix, digits, 2)
            m = row[mode]
            if status != DONE:
                begun = True
                break
            start, begun = 0.0, False
        x0, x1, x2, x3 = s[0], s[1], s[2], s[3]
        k += 1
    cursor[0], cursor[1], cursor[2], cursor[3] = k, start, count, begun
    if status == DONE or not begun:
        s[0], s[1], s[2], s[3] = x0, x1, x2, x3
    if status == DONE:
        for i in range(4):
            states[k, i] = s[i]
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

"""Exact event-driven simulation of a piecewise-linear plant: from event to event, no step size, no tolerance.

The plant is a set of *modes*, each a linear system with constant inputs and a constant term. With
s = [x, v, 1] (N states, M held inputs, one; C numbers in all), a mode gives

- delta @ s        the change of x over one whole sample (exact),
- rate @ s         dx/dt,

and for each element e (a shaft with backlash, or a friction)

- guard @ s        its guard function, which must stay within [lower, upper] while the mode lasts,
- guard_rate @ s   T · d(guard)/dt,
- swing @ |s|      T²/2 · max |second derivative of guard| over the sample,
- remainder @ |s|  T⁴/384 · max |fourth derivative of guard|, the error of the cubic Hermite interpolation.

One block of numbers holds all this for one mode: ``table[row]`` has N rows of delta, N of rate, then for each
element the rows guard, guard_rate, swing, remainder and [lower, upper, 0 …], then one row [longest piece, order of
the Taylor series, 0 …].

Every element has one *digit*; its order is along the axis of its guard, so that leaving by the lower bound lowers the
digit by one and leaving by the upper bound raises it by one (shaft: −, gap, +; friction: negative segments, stick,
positive segments). The mode is the number made of all digits.

A sample in which the enclosure excludes every crossing is one matrix product. Otherwise the state is expanded
in its Taylor series (converged to rounding on a piece that is short against the fastest pole), the first crossing
is found on that polynomial by steps that can be shown never to jump over a root, and the rest of the sample goes on
from there in the next mode.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

DONE, NEED_MODE, NEED_EVENT_SPACE, CHATTERING = 0, 1, 2, 3
SHAFT, FRICTION = 0, 1
#: Events within one sample beyond which the run is given up as chattering (chosen).
MAX_EVENTS_PER_SAMPLE = 10_000
#: Smallest step of the root search as a fraction of a piece: a few units of rounding of the time itself.
SMALLEST_STEP = 2.0**-50
#: Highest order of the Taylor series that the tables may ask for.
MAX_ORDER = 24
EVENT_COLUMNS = 5  # time in samples, element, old digit, new digit, speed at the element


#: Rows of `table` for each element, see the module's description.
GUARD, GUARD_RATE, SWING, REMAINDER, BOUNDS, ELEMENT_ROWS = 0, 1, 2, 3, 4, 5


class PlantTables(NamedTuple):
    """All modes of a plant, see the module's description."""

    table: Array  # (rows, 2 N + 5 E + 1, C)
    row: Indices  # (modes,): row of each mode, −1 while it was never entered
    radix: Indices  # (E,): weight of each element's digit in the mode's number
    kind: Indices  # (E,): SHAFT or FRICTION
    stick: Indices  # (E,): digit of rest, −1 for shafts
    speed_row: Array  # (E, N): the speed that is reported with an event
    reset_row: Array  # (E, 3, N + 1): for a shaft's digit 0, 1, 2: the value set on entering, see reset_slot
    reset_slot: Indices  # (E,): state that is set on entering a mode (rest: speed; physical law: shaft angle)


class Work(NamedTuple):
    """Scratch of the kernels: change of the state, Taylor coefficients of the state and of one guard."""

    change: Array  # (N,)
    series: Array  # (MAX_ORDER + 1, N)
    polynomial: Array  # (MAX_ORDER + 1,)


def new_work(states: int) -> Work:
    return Work(np.zeros(states), np.zeros((MAX_ORDER + 1, states)), np.zeros(MAX_ORDER + 1))


_PLANT = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy"}


@njit(inline="always", **_PLANT)
def mode_number(radix, digits, E):
    mode = 0
    for e in range(E):
        mode += digits[e] * radix[e]
    return mode


@njit(inline="always", **_PLANT)
def _quiet(table, m, s, change, N, C, E):
    """True if no guard can leave its bounds in the whole sample; `change` becomes the state's change over it."""
    for i in range(N):
        total = 0.0
        for j in range(C):
            total += table[m, i, j] * s[j]
        change[i] = total
    for e in range(E):
        at = 2 * N + ELEMENT_ROWS * e
        low, high = table[m, at + BOUNDS, 0], table[m, at + BOUNDS, 1]
        g0 = 0.0
        d0 = 0.0
        swing = 0.0
        for j in range(C):
            g0 += table[m, at + GUARD, j] * s[j]
            d0 += table[m, at + GUARD_RATE, j] * s[j]
            swing += table[m, at + SWING, j] * abs(s[j])
        if g0 + min(d0, 0.0) - swing > low and g0 + max(d0, 0.0) + swing < high:
            continue
        # Cubic Hermite through both ends: it lies between its Bernstein points; the remainder bounds its error.
        g1 = g0
        d1 = d0
        remainder = 0.0
        for j in range(C):
            remainder += table[m, at + REMAINDER, j] * abs(s[j])
        for j in range(N):
            g1 += table[m, at + GUARD, j] * change[j]
            d1 += table[m, at + GUARD_RATE, j] * change[j]
        b1 = g0 + d0 / 3.0
        b2 = g1 - d1 / 3.0
        if not (
            min(min(g0, g1), min(b1, b2)) - remainder > low
            and max(max(g0, g1), max(b1, b2)) + remainder < high
        ):
            return False
    return True


@njit(**_PLANT)
def _first_crossing(p, order, sign, bound, until):
    """First time in [0, until] at which q = sign·(p − bound) goes below zero; 2.0 if it does not.

    p holds polynomial coefficients on the normalised piece [0, 1]. Each step ends before the first root of a
    quadratic that lies below q, so that no root is jumped over; near a root it converges faster than Newton.
    """
    spread = 0.0
    third = 0.0
    for k in range(1, order + 1):
        spread += abs(p[k])
        third += k * (k - 1) * (k - 2) * abs(p[k])
    q0 = sign * (p[0] - bound)
    tolerance = 4.5e-16 * spread + 2.3e-16 * abs(bound)
    if q0 > spread + tolerance:
        return 2.0
    t = 0.0
    smallest = SMALLEST_STEP
    while True:
        q = p[order]
        q1 = 0.0
        q2 = 0.0
        for k in range(order - 1, -1, -1):
            q2 = q2 * t + q1
            q1 = q1 * t + q
            q = q * t + p[k]
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


@njit(**_PLANT)
def finish_sample(tb, s, digits, start, dt, k, work, events, count, N, C, E):
    """The rest of sample k from time `start` (s), event by event; returns status, time reached, event count."""
    t = start
    in_sample = 0
    # Taken out of the tuples once: numba counts references each time, which took longer than the arithmetic.
    table, row, radix, kind, stick = tb.table, tb.row, tb.radix, tb.kind, tb.stick
    speed_row, reset_row, reset_slot = tb.speed_row, tb.reset_row, tb.reset_slot
    series, p = work.series, work.polynomial
    last = table.shape[1] - 1
    while True:
        m = row[mode_number(radix, digits, E)]
        if m < 0:
            return NEED_MODE, t, count
        if dt - t <= 1e-15 * dt:
            return DONE, dt, count
        length = min(dt - t, table[m, last, 0])
        order = int(table[m, last, 1])
        for i in range(N):
            total = 0.0
            for j in range(C):
                total += table[m, N + i, j] * s[j]
            series[0, i] = s[i]
            series[1, i] = total * length
        for n in range(1, order):
            factor = length / (n + 1)
            for i in range(N):
                total = 0.0
                for j in range(N):
                    total += table[m, N + i, j] * series[n, j]
                series[n + 1, i] = total * factor

        first = 1.0
        which = -1
        direction = 0
        for e in range(E):
            guard = 2 * N + ELEMENT_ROWS * e + GUARD
            for n in range(order + 1):
                total = 0.0
                for j in range(N):
                    total += table[m, guard, j] * series[n, j]
                p[n] = total
            for j in range(N, C):
                p[0] += table[m, guard, j] * s[j]
            lower, upper = table[m, guard + BOUNDS, 0], table[m, guard + BOUNDS, 1]
            if lower > -np.inf:
                at = _first_crossing(p, order, 1.0, lower, first)
                if at <= first:
                    first, which, direction = at, e, -1
            if upper < np.inf:
                at = _first_crossing(p, order, -1.0, upper, first)
                if at <= first:
                    first, which, direction = at, e, 1

        if which >= 0 and count == events.shape[0]:
            return NEED_EVENT_SPACE, t, count
        if first > 0.0:
            for i in range(N):
                total = series[order, i]
                for n in range(order - 1, -1, -1):
                    total = total * first + series[n, i]
                s[i] = total
        t += first * length
        if which < 0:
            continue
        in_sample += 1
        if in_sample > MAX_EVENTS_PER_SAMPLE:
            return CHATTERING, t, count
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
        at = k + t / dt
        if (
            old == stick[which]
            and count > 0
            and events[count - 1, 0] == at
            and events[count - 1, 1] == which
            and events[count - 1, 3] == old
        ):
            count -= 1  # passed through rest without staying: neither stick nor slip
            continue
        events[count, 0] = at
        events[count, 1] = which
        events[count, 2] = old
        events[count, 3] = new
        events[count, 4] = speed
        count += 1


@njit(inline="always", **_PLANT)
def _open_loop(tb, s, digits, inputs, dt, work, states, modes, events, cursor, N, M, E):
    C = N + M + 1
    table, row, radix, change = tb.table, tb.row, tb.radix, work.change
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    status = DONE
    while k < inputs.shape[0]:
        mode = mode_number(radix, digits, E)
        m = row[mode]
        if m < 0:
            status = NEED_MODE
            break
        quiet = False
        if start == 0.0:
            for j in range(M):
                s[N + j] = inputs[k, j]
            for i in range(N):
                states[k, i] = s[i]
            modes[k] = mode
            quiet = _quiet(table, m, s, change, N, C, E)
        if quiet:
            for i in range(N):
                s[i] += change[i]
        else:
            status, start, count = finish_sample(tb, s, digits, start, dt, k, work, events, count, N, C, E)
            if status != DONE:
                break
            start = 0.0
        k += 1
    cursor[0] = k
    cursor[1] = start
    cursor[2] = count
    if status == DONE:
        for i in range(N):
            states[k, i] = s[i]
        modes[k] = mode_number(radix, digits, E)
    return status


@njit(**_PLANT)
def run_open_loop(tb, s, digits, inputs, dt, work, states, modes, events, cursor):
    """Any plant with torques given: fills states (n + 1, N) and modes (n + 1,); returns a status.

    Parameters
    ----------
    s : (C,) array
        [x, v, 1], changed in place.  digits : (E,) int64, changed in place.
    inputs : (n, M) array
    work : Work
    events : (space, EVENT_COLUMNS) array
    cursor : (3,) array
        Sample, time within it (s), events so far: where to go on after NEED_MODE or NEED_EVENT_SPACE.
    """
    E = digits.size
    M = inputs.shape[1]
    return _open_loop(tb, s, digits, inputs, dt, work, states, modes, events, cursor, s.size - M - 1, M, E)


@njit(**_PLANT)
def run_open_loop_two_mass(tb, s, digits, inputs, dt, work, states, modes, events, cursor):
    """`run_open_loop` with the sizes of the usual two-mass plant known to the compiler (a quarter of the time)."""
    return _open_loop(tb, s, digits, inputs, dt, work, states, modes, events, cursor, 4, 1, 2)

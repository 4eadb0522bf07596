"""Many variants of one plant under the same torques: summaries only, in blocks that stay in the nearest cache.

Each variant builds its own modes as it enters them (``kernels.modes``) and runs by ``kernels.plant``, a block of
samples at a time. Peaks and squares are summed up by place in the block, which needs no sum across a register; the
places are joined at the end. Nothing here holds Python's lock, so variants run on as many threads as there are cores.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit

from .mode_rows import ANGLE, ELEMENT, GAP, SHAFT_NUMBERS, Chain, start_digits
from .modes import build_mode
from .plant import (
    CHATTERING,
    DONE,
    EVENT_COLUMNS,
    MAX_EVENTS_PER_SAMPLE,
    NEED_EVENT_SPACE,
    NEED_MODE,
    run_open_loop,
)
from .plant_tables import FRICTION, SHAFT, Array, Indices, PlantTables, new_work, padded
from .two_mass import run_open_loop_two_mass
from .vectors import LANES, absolute, address, fused, larger, load, multiply, read, store, total, write

#: Samples in a block (chosen: 48 kB of states and sums for two masses).
BLOCK = 512
#: Events that a block may hold before they are counted (chosen).
EVENT_SPACE = 64
#: Kinds of events, in the order of the counts.
IMPACT, SEPARATION, STICK, SLIP, NONE = range(5)


class Family(NamedTuple):
    """What is the same for all variants.

    Signals are rows over s and the shaft torques, or a state as it is: `state` ≥ 0.
    """

    chain: Chain
    radix: Indices  # (E,), and below, as in ``plant_tables.PlantTables``
    modes: int  # combinations of digits
    kind: Indices
    stick: Indices
    speed_row: Array
    reset_row: Array
    reset_slot: Indices
    size: int  # of a mode's block
    order: int
    idle: int
    inputs: Array  # (n, M)
    start: Array  # (N,)
    digits: Indices  # (E,), or (0,): told by the start
    last: float  # torque set-point before the first sample, Nm
    signal: Array  # (S, C + n − 1)
    state: Indices  # (S,)
    sampled: Indices  # (Q,): signals kept at every `step`-th sample
    step: int


class Summary(NamedTuple):
    """Filled by `run_variants`, one row for each variant."""

    status: Indices
    final: Array  # (V, N)
    peak: Array  # (V, S)
    square: Array  # (V, S): sum of squares
    events: Indices  # (V, 4)
    samples: Array  # (V, Q, T)


class Scratch(NamedTuple):
    """What one thread needs."""

    work: Array
    inputs: Array  # (BLOCK, M)
    states: Array  # (BLOCK + LANES, N)
    modes: Indices  # (BLOCK + 1,)
    events: Array  # (EVENT_SPACE, EVENT_COLUMNS + N)
    peaks: Array  # (BLOCK · N,): by place in the block
    squares: Array
    values: Array  # (S, BLOCK): of signals that are no states
    value_peaks: Array
    value_squares: Array
    row: Indices  # (modes,)
    reset_row: Array


def new_scratch(family: Family) -> Scratch:
    states, inputs, signals = family.start.size, family.inputs.shape[1], family.signal.shape[0]
    return Scratch(
        new_work(states), np.zeros((BLOCK, inputs)), np.zeros((BLOCK + LANES, states)), np.zeros(BLOCK + 1, np.int64),
        np.zeros((EVENT_SPACE, EVENT_COLUMNS + states)), np.zeros(BLOCK * states), np.zeros(BLOCK * states),
        np.zeros((signals, BLOCK)), np.zeros((signals, BLOCK)), np.zeros((signals, BLOCK)),
        np.zeros(family.modes, np.int64), family.reset_row.copy(),
    )  # fmt: skip


_BATCH: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True}
_INNER: Any = {**_BATCH, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


@njit(**_INNER)
def _set_resets(chain, p, reset_row):
    """The shaft angle on entering a contact is the twist beyond half the backlash (physical law)."""
    n, states = chain.inertias.shape[0] - 1, chain.states
    for i in range(n - 1):
        if chain.shafts[i, ANGLE] >= 0:
            half = p[2 + n + SHAFT_NUMBERS * i + 2]
            for digit in range(3):
                reset_row[chain.shafts[i, ELEMENT], digit, states] = -(digit - GAP) * half


@njit(**_INNER)
def _limit(given, first, count, limit, step, last, inputs):
    """The block's inputs with the torque within the actuator's limits; returns the last set-point."""
    for j in range(inputs.shape[1]):
        for k in range(count):
            inputs[k, j] = given[first + k, j]
    if limit < np.inf:
        for k in range(count):
            inputs[k, 0] = min(max(inputs[k, 0], -limit), limit)
    if step < np.inf:
        for k in range(count):
            last = min(max(inputs[k, 0], last - step), last + step)
            inputs[k, 0] = last
    return last


@njit(**_INNER)
def _signal_rows(signal, state, torques, states, rows):
    """Rows of the signals that are no states, in the mode whose shaft torques are given: see `_fill_values`."""
    columns, apart = torques.shape[1], padded(states) - states
    for i in range(state.size):
        if state[i] >= 0:
            continue
        for j in range(columns):
            value = signal[i, j]
            for m in range(signal.shape[1] - columns):
                value += signal[i, columns + m] * torques[m, j]
            rows[i, j if j < states else j + apart] = value


@njit(**_INNER)
def _count_events(events, count, first, kind, rest, previous, counts):
    """Adds events to the counts; a pair that enters and leaves a digit at once does not count.

    previous: time, element, new digit, kind of the event before (NONE if it did not count).
    """
    for i in range(count):
        time, e, old, new = events[i, 0] + first, events[i, 1], events[i, 2], events[i, 3]
        element = int(e)
        what = NONE
        if kind[element] == SHAFT:
            what = SEPARATION if new == GAP else IMPACT
        elif kind[element] == FRICTION:
            if new == rest[element]:
                what = STICK
            elif old == rest[element]:
                what = SLIP
        if time == previous[0] and e == previous[1] and old == previous[2]:
            if previous[3] != NONE:
                counts[int(previous[3])] -= 1
            what = NONE
        if what != NONE:
            counts[what] += 1
        previous[0], previous[1], previous[2], previous[3] = time, e, new, what


@njit(**_INNER)
def _sum_up(values, count, peaks, squares):
    """Largest absolute values and sums of squares, place by place; all by their addresses."""
    whole = count & -LANES
    for j in range(0, whole, LANES):
        value = load(values, j)
        store(peaks, j, larger(load(peaks, j), absolute(value)))
        store(squares, j, fused(value, value, load(squares, j)))
    for j in range(whole, count):
        value = read(values, j)
        write(peaks, j, max(read(peaks, j), abs(value)))
        write(squares, j, read(squares, j) + value * value)


@njit(**_INNER)
def _fill_values(family, scratch, count, rows):
    """Signals that are no states, run by run of samples in one mode.

    rows: (modes, S, high + M + 1), for the states in whole groups of LANES, the inputs, and one. A group may reach into
    the next sample's states; its numbers are zero there.
    """
    modes, inputs, states = scratch.modes, scratch.inputs, address(scratch.states)
    number, high = family.chain.states, padded(family.chain.states)
    for i in range(family.state.size):
        if family.state[i] >= 0:
            continue
        values = scratch.values[i]
        k = 0
        while k < count:
            m, stop = modes[k], k + 1
            while stop < count and modes[stop] == m:
                stop += 1
            row = rows[scratch.row[m], i]
            constant, at = row[row.size - 1], address(row)
            four = load(at, 0)
            for sample in range(k, stop):
                values[sample] = constant + total(multiply(four, load(states, sample * number)))
            for j in range(LANES, high, LANES):
                four = load(at, j)
                for sample in range(k, stop):
                    values[sample] += total(multiply(four, load(states, sample * number + j)))
            for j in range(inputs.shape[1]):
                if row[high + j] != 0.0:
                    for sample in range(k, stop):
                        values[sample] += row[high + j] * inputs[sample, j]
            k = stop


@njit(**_INNER)
def _keep(family, scratch, first, count, samples):
    """Every `step`-th sample of the signals whose quantiles are wanted."""
    step = family.step
    for q in range(family.sampled.size):
        i = family.sampled[q]
        at = (first + step - 1) // step
        k = at * step - first
        while k < count:
            state = family.state[i]
            samples[q, at] = scratch.states[k, state] if state >= 0 else scratch.values[i, k]
            k += step
            at += 1


@njit(**_INNER)
def _join(family, scratch, peak, square):
    """Peaks and sums of squares over all places in the block."""
    states = family.chain.states
    for i in range(family.state.size):
        j = family.state[i]
        highest, total = 0.0, 0.0
        for k in range(BLOCK):
            if j >= 0:
                highest = max(highest, scratch.peaks[k * states + j])
                total += scratch.squares[k * states + j]
            else:
                highest = max(highest, scratch.value_peaks[i, k])
                total += scratch.value_squares[i, k]
        peak[i], square[i] = highest, total


@njit(**_INNER)
def _clear(scratch):
    scratch.peaks[:] = 0.0
    scratch.squares[:] = 0.0
    scratch.value_peaks[:] = 0.0
    scratch.value_squares[:] = 0.0
    scratch.row[:] = -1


@njit(**_BATCH)
def run_variants(
    family, numbers, limits, scratch, mode_rows, mode_bounds, mode_weights, mode_scratch, summary
):
    """Runs every variant to its end, or to what stops it: its status, DONE or CHATTERING, tells.

    Parameters
    ----------
    family : Family
    numbers : (V, P) array
        See ``mode_rows.Chain``.
    limits : (V, 2) array
        Largest torque, Nm, and its largest change from sample to sample, Nm.
    scratch : Scratch
    mode_rows … mode_scratch
        The arrays of a ``modes.ModeWork``.
    summary : Summary
    """
    chain, radix, kind, rest, size = family.chain, family.radix, family.kind, family.stick, family.size
    n, length = chain.inertias.shape[0] - 1, family.inputs.shape[0]
    states, inputs = chain.states, family.inputs.shape[1]
    usual = states == 4 and inputs == 1 and radix.size == 2
    derived = False
    for i in range(family.state.size):
        derived = derived or family.state[i] < 0
    flat = np.zeros(min(family.modes, 16) * size)
    rows = np.zeros((min(family.modes, 16), family.state.size, padded(states) + inputs + 1))
    s, cursor = np.zeros(states + inputs + 1), np.zeros(5)
    digits, previous = np.zeros(radix.size, np.int64), np.zeros(4)
    for v in range(numbers.shape[0]):
        p = numbers[v]
        _clear(scratch)
        _set_resets(chain, p, scratch.reset_row)
        s[:states] = family.start
        s[-1] = 1.0
        if family.digits.size == radix.size and radix.size > 0:
            digits[:] = family.digits
        else:
            start_digits(chain, p, s, digits)
        counts = summary.events[v]
        previous[:] = -1.0
        last, built, status, first = family.last, 0, DONE, 0
        while first < length and status == DONE:
            count = min(BLOCK, length - first)
            last = _limit(family.inputs, first, count, limits[v, 0], limits[v, 1], last, scratch.inputs)
            cursor[:] = 0.0
            crowd, crowded = 0.0, -1.0
            while True:
                tables = PlantTables(
                    flat, scratch.row, radix, kind, rest, family.speed_row, scratch.reset_row, family.reset_slot,
                    family.order, family.idle,
                )  # fmt: skip
                given = scratch.inputs[:count]
                if usual:
                    status = run_open_loop_two_mass(
                        tables,
                        s,
                        digits,
                        given,
                        scratch.work,
                        scratch.states,
                        scratch.modes,
                        scratch.events,
                        cursor,
                    )
                else:
                    status = run_open_loop(
                        tables,
                        s,
                        digits,
                        given,
                        scratch.work,
                        scratch.states,
                        scratch.modes,
                        scratch.events,
                        cursor,
                    )
                if status == NEED_MODE:
                    if built * size == flat.size:
                        flat = np.concatenate((flat, np.zeros_like(flat)))
                        rows = np.concatenate((rows, np.zeros_like(rows)))
                    build_mode(
                        chain,
                        p,
                        digits,
                        flat,
                        built * size,
                        mode_rows,
                        mode_bounds,
                        mode_weights,
                        mode_scratch,
                    )
                    _signal_rows(family.signal, family.state, mode_rows[: n - 1], states, rows[built])
                    mode = 0
                    for e in range(radix.size):
                        mode += digits[e] * radix[e]
                    scratch.row[mode] = built
                    built += 1
                    continue
                _count_events(scratch.events, int(cursor[2]), first, kind, rest, previous, counts)
                if status != NEED_EVENT_SPACE:
                    break
                # A full event space in the same sample, again and again: the kernel sees one at a time.
                crowd = crowd + cursor[2] if cursor[0] == crowded else cursor[2]
                crowded = cursor[0]
                if crowd > MAX_EVENTS_PER_SAMPLE:
                    status = CHATTERING
                    break
                cursor[2] = 0.0
            if status != DONE:
                break
            _sum_up(address(scratch.states), count * states, address(scratch.peaks), address(scratch.squares))
            if derived:
                _fill_values(family, scratch, count, rows)
                for i in range(family.state.size):
                    if family.state[i] < 0:
                        at = 8 * BLOCK * i
                        _sum_up(
                            address(scratch.values) + at, count,
                            address(scratch.value_peaks) + at, address(scratch.value_squares) + at,
                        )  # fmt: skip
            _keep(family, scratch, first, count, summary.samples[v])
            first += count
        summary.status[v] = status
        summary.final[v] = s[:states]
        _join(family, scratch, summary.peak[v], summary.square[v])

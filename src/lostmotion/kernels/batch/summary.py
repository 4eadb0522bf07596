"""Sums up a block of samples of one variant: events, peaks, squares, and the samples for quantiles."""

from __future__ import annotations

from typing import Any

from ..jit import njit
from ..numerics.vectors import (
    LANES,
    absolute,
    address,
    fused,
    larger,
    load,
    multiply,
    read,
    store,
    total,
    write,
)
from ..plant.equations import GAP
from ..plant.layout import AT_ONCE, FRICTION, SHAFT, padded
from .arrays import BLOCK

#: Kinds of events, in the order of the counts.
IMPACT, SEPARATION, STICK, SLIP, NONE = range(5)

_INNER: Any = {
    "cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True, "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # fmt: skip


@njit(**_INNER)
def count_events(events, count, first, kind, rest, previous, counts):
    """Adds events to the counts; a pair that enters and leaves a digit at once does not count.

    previous: time, element, new digit, kind of the event before (NONE if it did not count). Its time is −1 where there
    is none, or where it is the second of a pair: of three changes at once the last one counts.
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
        if time - previous[0] <= AT_ONCE and e == previous[1] and old == previous[2]:
            if previous[3] != NONE:
                counts[int(previous[3])] -= 1
            time, what = -1.0, NONE
        if what != NONE:
            counts[what] += 1
        previous[0], previous[1], previous[2], previous[3] = time, e, new, what


@njit(**_INNER)
def sum_up(values, count, peaks, squares):
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
def signal_rows(signal, state, torques, states, rows):
    """Rows of the signals that are no states, in the mode whose shaft torques are given: see `fill_values`."""
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
def fill_values(family, scratch, count, rows):
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
def keep(family, scratch, first, count, samples):
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
def join(family, scratch, peak, square):
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
def clear(scratch):
    scratch.peaks[:] = 0.0
    scratch.squares[:] = 0.0
    scratch.value_peaks[:] = 0.0
    scratch.value_squares[:] = 0.0
    scratch.row[:] = -1

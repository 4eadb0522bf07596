"""Many variants of one plant under the same laws: each runs whole, and its signals are summed up."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..jit import njit
from ..loop.blocks import run_with_laws
from ..loop.laws import Loop
from ..numerics.vectors import address, read
from ..plant.entered import Entered
from ..plant.equations import start_digits
from ..plant.event_loop import NEED_EVENT_SPACE, empty_event_space
from ..plant.layout import Array, Indices
from .arrays import EVENT_SPACE
from .resets import set_resets
from .summary import count_events

_BATCH: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True}

#: Where a signal is found: the plant's own, a law's output, a torque, a signal from outside, a sensor.
OWN, OUTPUT, TORQUE, GIVEN, MEASURED = range(5)


class LawFamily(NamedTuple):
    """What is the same for all variants, and the arrays of one thread."""

    entered: Entered  # its numbers are those of the variant that runs
    two_mass: bool
    loop: Loop  # its state, limits and signals likewise
    first_state: Array  # the laws' states at the start
    start: Array  # (N,)
    digits: Indices  # (E,), or (0,): given by the start
    last: float  # torque set-point before the first sample, Nm
    work: Array
    states: Array  # of a block
    modes: Indices
    values: Array  # (signals, n): the plant's own
    wanted: Indices  # (S, 2): OWN … MEASURED, and the row or column there
    sampled: Indices  # (Q,): wanted signals kept at every `step`-th sample
    step: int


@njit(**_BATCH)
def run_variants_with_laws(family, steps, numbers, limits, summary):
    """Runs every variant to its end, or to what stops it: its status tells.

    Parameters
    ----------
    family : LawFamily
    steps : typed list
        The steppers' step functions, see ``loop.laws.no_steps``.
    numbers : (V, P) array
        See ``equations.Chain``.
    limits : (V, 2) array
        Largest torque, Nm, and its largest change from sample to sample, Nm.
    summary : Summary
    """
    entered, loop, states = family.entered, family.loop, family.start.size
    tables, chain = entered.tables, entered.chain
    s = np.zeros(states + loop.torque.shape[1] + 1)
    digits, previous, cursor = np.zeros(tables.radix.size, np.int64), np.zeros(4), np.zeros(6)
    crowd = np.empty(2)
    events = np.empty((EVENT_SPACE, 6 + states))
    for v in range(numbers.shape[0]):
        entered.numbers[:] = numbers[v]
        entered.built[0] = 0
        tables.row[:] = -1
        set_resets(chain, numbers[v], tables.reset_row)
        s[:states] = family.start
        s[-1] = 1.0
        if family.digits.size == digits.size:
            digits[:] = family.digits
        else:
            start_digits(chain, numbers[v], s, digits)
        loop.state[:] = family.first_state
        loop.last[:] = np.nan
        loop.limits[:] = limits[v]
        previous[:] = -1.0
        cursor[:] = 0.0
        cursor[4] = family.last
        crowd[:] = -1.0
        while True:
            status = run_with_laws(
                entered, family.two_mass, s, digits, loop, steps, family.work, family.states, family.modes, events,
                cursor, family.values,
            )  # fmt: skip
            count_events(events, int(cursor[2]), 0, tables.kind, tables.stick, previous, summary.events[v])
            status = empty_event_space(status, cursor, crowd)
            if status != NEED_EVENT_SPACE:
                break
        summary.status[v] = status
        summary.final[v] = s[:states]
        _sum_up(family, summary.peak[v], summary.square[v], summary.samples[v])


@njit(**_BATCH)
def _place(family, signal):
    """Address of a wanted signal's first number, and how many numbers it is to the next one."""
    loop, kind, at = family.loop, family.wanted[signal, 0], family.wanted[signal, 1]
    if kind == OWN:
        return address(family.values) + 8 * at * family.values.shape[1], 1
    if kind == OUTPUT:
        return address(loop.outputs) + 8 * at, loop.outputs.shape[1]
    if kind == TORQUE:
        return address(loop.torque) + 8 * at, loop.torque.shape[1]
    if kind == GIVEN:
        return address(loop.given) + 8 * at, loop.given.shape[1]
    return address(loop.measured) + 8 * at, loop.measured.shape[1]


@njit(**_BATCH)
def _sum_up(family, peak, square, samples):
    """Largest absolute values, sums of squares, and what is kept of the signals."""
    for i in range(peak.size):
        at, stride = _place(family, i)
        highest, total = 0.0, 0.0
        for k in range(family.values.shape[1]):
            value = read(at, stride * k)
            highest = max(highest, abs(value))
            total += value * value
        peak[i], square[i] = highest, total
    for q in range(samples.shape[0]):
        at, stride = _place(family, family.sampled[q])
        for j in range(samples.shape[1]):
            samples[q, j] = read(at, stride * family.step * j)

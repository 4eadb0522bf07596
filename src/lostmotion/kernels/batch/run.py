"""Many variants of one plant under the same torques: summaries only, in blocks that stay in the nearest cache.

Each variant builds its own modes as it enters them (``kernels.plant.contact_states``) and runs by
``kernels.plant.event_loop``, a block of samples at a time. Peaks and squares are summed up by place in the block, which
needs no sum across a register; the places are joined at the end. Nothing here holds Python's lock, so variants run on
as many threads as there are cores.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..jit import njit
from ..loop.any_plant import run_open_loop
from ..loop.two_mass import run_open_loop_two_mass
from ..numerics.vectors import address
from ..plant.contact_states import build_mode
from ..plant.equations import start_digits
from ..plant.event_loop import (
    DONE,
    NEED_EVENT_SPACE,
    NEED_MODE,
    empty_event_space,
)
from ..plant.layout import PlantTables, padded
from .arrays import BLOCK
from .resets import set_resets
from .summary import clear, count_events, fill_values, join, keep, signal_rows, sum_up

_BATCH: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True}
_INNER: Any = {**_BATCH, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


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
    digits, previous, crowd = np.zeros(radix.size, np.int64), np.zeros(4), np.empty(2)
    for v in range(numbers.shape[0]):
        p = numbers[v]
        clear(scratch)
        set_resets(chain, p, scratch.reset_row)
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
            crowd[:] = -1.0
            while True:
                tables = PlantTables(
                    flat, scratch.row, radix, kind, rest, family.speed_row, scratch.reset_row, family.reset_slot,
                    family.order, family.idle,
                )  # fmt: skip
                given = scratch.inputs[:count]
                if usual:
                    status = run_open_loop_two_mass(
                        tables, s, digits, given, 0, count, scratch.work, scratch.states, scratch.modes, scratch.events,
                        cursor,
                    )  # fmt: skip
                else:
                    status = run_open_loop(
                        tables, s, digits, given, 0, count, scratch.work, scratch.states, scratch.modes, scratch.events,
                        cursor,
                    )  # fmt: skip
                if status == NEED_MODE:
                    if built * size == flat.size:
                        flat = np.concatenate((flat, np.zeros_like(flat)))
                        rows = np.concatenate((rows, np.zeros_like(rows)))
                    build_mode(
                        chain, p, digits, flat, built * size, mode_rows, mode_bounds, mode_weights, mode_scratch
                    )  # fmt: skip
                    signal_rows(family.signal, family.state, mode_rows[: n - 1], states, rows[built])
                    mode = 0
                    for e in range(radix.size):
                        mode += digits[e] * radix[e]
                    scratch.row[mode] = built
                    built += 1
                    continue
                count_events(scratch.events, int(cursor[2]), first, kind, rest, previous, counts)
                status = empty_event_space(status, cursor, crowd)
                if status != NEED_EVENT_SPACE:
                    break
            if status != DONE:
                break
            sum_up(address(scratch.states), count * states, address(scratch.peaks), address(scratch.squares))
            if derived:
                fill_values(family, scratch, count, rows)
                for i in range(family.state.size):
                    if family.state[i] < 0:
                        at = 8 * BLOCK * i
                        sum_up(
                            address(scratch.values) + at, count,
                            address(scratch.value_peaks) + at, address(scratch.value_squares) + at,
                        )  # fmt: skip
            keep(family, scratch, first, count, summary.samples[v])
            first += count
        summary.status[v] = status
        summary.final[v] = s[:states]
        join(family, scratch, summary.peak[v], summary.square[v])

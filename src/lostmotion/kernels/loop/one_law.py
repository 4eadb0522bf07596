"""A plant with a law in the loop: sensors, one law step, torque limit and delay, then one exact sample of the plant."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from ..law.step import step_at
from ..numerics.vectors import (
    address,
    read,
    read_integer,
    write,
    write_integer,
)
from ..plant.enclosure import no_crossing
from ..plant.event_loop import DONE, NEED_MODE, add_change, finish_sample
from ..plant.layout import COMPILED, INNER, Array, Indices, block_size, mode_number, places_of


class SensorTables(NamedTuple):
    """How each input of the law is made from the plant and from the outside.

    Input i is the plant's signal source[i] for source[i] ≥ 0, see ``Entered.signal``, else column −1 − source[i] of the
    given signals. Then: resolution[i] > 0 rounds down to whole steps; difference[i] = 1 takes the difference to the
    sample before over dt; last comes disturbance[k, i] (noise and bias; NaN is a drop-out).
    """

    source: Indices
    resolution: Array
    difference: Indices
    last: Array  # (inputs,): the value of the sample before, NaN before the first
    disturbance: Array  # (n, inputs), or (1, inputs) where it is the same in every sample
    exact: Indices  # 1: shows the true value


class LoopTables(NamedTuple):
    """What happens once per sample before the plant moves.

    given : (n, G) signals from outside that the law or the plant reads (set-points, load torque).
    drive : (M,) for each plant input: ≥ 0 the law's output, < 0 column −1 − drive of `given`.
    every : samples of the plant from one law step to the next.
    delay : the torque computed at sample k acts from sample k + delay on.
    limit, step : torque limit of the actuator, Nm, and its largest change from sample to sample.
    law, state : see ``law.law_step``.
    torque : (n, M), measured : (n, inputs), outputs : (n + delay, outputs), faults : (n,)
        Filled: the torque that acts in sample k, the law's inputs at k, its outputs computed at k or at the last law
        step before (row k + delay), the bit mask of bad inputs.
    """

    sensors: SensorTables
    given: Array
    drive: Indices
    every: int
    delay: int
    limit: float
    step: float
    dt: float
    code: int
    numbers: Array
    state: Array
    torque: Array
    measured: Array
    outputs: Array
    faults: Indices


class _Places(NamedTuple):
    """Addresses and sizes of all that, see ``plant.Places``."""

    signal: int
    span: int
    source: int
    resolution: int
    difference: int
    last: int
    disturbance: int
    noise_row: int
    exact: int
    signals: int
    columns: int
    given: int
    given_row: int
    drive: int
    every: int
    delay: int
    limit: float
    step: float
    law_dt: float
    code: int
    numbers: int
    state: int
    torque: int
    measured: int
    outputs: int
    faults: int
    n_torques: int
    n_inputs: int
    n_outputs: int


@njit(forceinline=True, **INNER)
def loop_places(entered, loop):
    s = loop.sensors
    return _Places(
        address(entered.signal), address(entered.span), address(s.source), address(s.resolution), address(s.difference),
        address(s.last), address(s.disturbance), s.disturbance.shape[1] if s.disturbance.shape[0] > 1 else 0,
        address(s.exact),
        entered.signal.shape[1], entered.signal.shape[2], address(loop.given), loop.given.shape[1], address(loop.drive),
        loop.every, loop.delay, loop.limit, loop.step, loop.dt * loop.every, loop.code, address(loop.numbers),
        address(loop.state), address(loop.torque), address(loop.measured), address(loop.outputs),
        address(loop.faults), loop.torque.shape[1], loop.measured.shape[1], loop.outputs.shape[1],
    )  # fmt: skip


@njit(**INNER)
def _shown(p, value, i, k):
    """What the sensor of input i shows in sample k."""
    resolution = read(p.resolution, i)
    if resolution > 0.0:
        value = np.floor(value / resolution) * resolution
    if read_integer(p.difference, i) == 1:
        now, before = value, read(p.last, i)
        value = 0.0 if np.isnan(before) else (now - before) / p.law_dt
        write(p.last, i, now)
    return value + read(p.disturbance, k * p.noise_row + i)


@njit(forceinline=True, **INNER)
def _measure(p, m, s, k):
    """The law's inputs in sample k, to their row."""
    for i in range(p.n_inputs):
        source = read_integer(p.source, i)
        if source >= 0:
            place = m * p.signals + source
            value = 0.0
            for j in range(read_integer(p.span, 2 * place), read_integer(p.span, 2 * place + 1)):
                value += read(p.signal, place * p.columns + j) * read(s, j)
        else:
            value = read(p.given, k * p.given_row - 1 - source)
        if read_integer(p.exact, i) == 0:
            value = _shown(p, value, i, k)
        write(p.measured, k * p.n_inputs + i, value)


@njit(forceinline=True, **INNER)
def control(p, m, s, k, last):
    """Sensors and law of sample k, and the torques on the plant, which s holds then; returns the first one."""
    u, y = k * p.n_inputs, (k + p.delay) * p.n_outputs
    if p.every == 1 or k % p.every == 0:
        _measure(p, m, s, k)
        bad = step_at(p.code, p.numbers, p.state, p.measured + 8 * u, p.outputs + 8 * y)
        write_integer(p.faults, k, bad)
    else:
        for i in range(p.n_inputs):
            write(p.measured, u + i, read(p.measured, u - p.n_inputs + i))
        for i in range(p.n_outputs):
            write(p.outputs, y + i, read(p.outputs, y - p.n_outputs + i))
    first = last
    for j in range(p.n_torques):
        drive = read_integer(p.drive, j)
        value = (
            read(p.outputs, k * p.n_outputs + drive)
            if drive >= 0
            else read(p.given, k * p.given_row - 1 - drive)
        )
        if j == 0:
            value = min(max(value, -p.limit), p.limit)
            value = min(max(value, last - p.step), last + p.step)
            first = value
        write(p.torque, k * p.n_torques + j, value)
        write(s, p.columns - 1 - p.n_torques + j, value)
    return first


@njit(**COMPILED)
def run_closed_loop(entered, s, digits, loop, first, stop, work, states, modes, events, cursor):
    """Any plant with a law in the loop; as ``event_loop.run_open_loop``, and

    Parameters
    ----------
    entered : Entered
    loop : LoopTables
    cursor : (5,) array
        As in ``event_loop.run_open_loop``, then the torque of the last sample.
    """
    tb = entered.tables
    E = digits.size
    M = loop.torque.shape[1]
    C = s.size
    N = C - M - 1
    row, radix, idle, places, p = tb.row, tb.radix, tb.idle, places_of(tb, work), loop_places(entered, loop)
    base, x, change = places.flat, address(s), address(work)
    size = block_size(N, C, E, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    last = cursor[4]
    status = DONE
    mode = mode_number(radix, digits, E)
    while k < stop:
        m = row[mode]
        if m < 0:
            status = NEED_MODE
            break
        quiet = False
        if not begun:
            for i in range(N):
                states[k - first, i] = s[i]
            modes[k - first] = mode
            last = control(p, m, x, k, last)
            quiet = no_crossing(base + 8 * m * size, x, change, N, C, E, idle)
        if quiet:
            add_change(x, change, N)
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
    cursor[0], cursor[1], cursor[2], cursor[3], cursor[4] = k, start, count, begun, last
    if status == DONE:
        for i in range(N):
            states[k - first, i] = s[i]
        modes[k - first] = mode
    return status

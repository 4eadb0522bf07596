"""A plant with a law in the loop: sensors, one law step, torque limit and delay, then one exact sample of the plant."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from .law import law_step
from .plant import DONE, NEED_MODE, Array, Indices, _quiet, block_size, finish_sample, mode_number, places_of
from .vectors import address, read


class SensorTables(NamedTuple):
    """How each input of the law is made from the plant and from the outside.

    Input i is ``signal[mode's row, source[i]] @ s`` for source[i] ≥ 0, else column −1 − source[i] of the given
    signals. Then: resolution[i] > 0 rounds down to whole steps; difference[i] = 1 takes the difference to the sample
    before over dt; last comes disturbance[k, i] (noise and bias; NaN is a drop-out).
    """

    signal: Array  # (rows, signals, C)
    source: Indices
    resolution: Array
    difference: Indices
    last: Array  # (inputs,): the value of the sample before, NaN before the first
    disturbance: Array  # (n, inputs), or (1, inputs) where it is the same in every sample


@njit(cache=True, error_model="numpy")
def _measure(sensors, m, s, given, k, dt, values):
    signal, source, resolution = sensors.signal, sensors.source, sensors.resolution
    difference, last, disturbance = sensors.difference, sensors.last, sensors.disturbance
    for i in range(values.size):
        if source[i] >= 0:
            value = 0.0
            for j in range(s.size):
                value += signal[m, source[i], j] * s[j]
        else:
            value = given[k, -1 - source[i]]
        if resolution[i] > 0.0:
            value = np.floor(value / resolution[i]) * resolution[i]
        if difference[i] == 1:
            now = value
            value = 0.0 if np.isnan(last[i]) else (now - last[i]) / dt
            last[i] = now
        values[i] = value + disturbance[k if disturbance.shape[0] > 1 else 0, i]


@njit(cache=True, error_model="numpy")
def run_closed_loop(
    tb, s, digits, given, drive, every, delay, limit, step, law, law_state, sensors, dt, work,
    states, modes, torque, measured, outputs, law_work, law_inputs, made, events, cursor,
):  # fmt: skip
    """The plant with a law in the loop, one law step per sample; as ``plant.run_open_loop``, and

    Parameters
    ----------
    given : (n, G) array
        Signals from outside that the law or the plant reads (set-points, load torque).
    drive : (M,) int64 array
        For each plant input: ≥ 0 the law's output, < 0 column −1 − drive of `given`.
    every : int
        Samples of the plant from one law step to the next.
    delay : int
        The torque computed at sample k acts from sample k + delay on.
    limit, step : float
        Torque limit of the actuator, Nm, and its largest change from sample to sample.
    law, law_state, law_work
        See ``law.law_step``.
    torque : (n, M), measured : (n, inputs), outputs : (n + delay + every, outputs)
        Filled: the torque that acts in sample k, the law's inputs at k, its outputs computed at k or at the last law
        step before (row k + delay).  law_inputs, made : scratch, and the law's inputs of the last law step.
    cursor : (5,) array
        As in ``plant.run_open_loop``, then the set-point of the last sample.
    """
    E = digits.size
    M = torque.shape[1]
    C = s.size
    N = C - M - 1
    row, radix, idle, places = tb.row, tb.radix, tb.idle, places_of(tb, work)
    base, x, change = places.flat, address(s), address(work)
    size = block_size(N, C, E, tb.order)
    k = int(cursor[0])
    start = cursor[1]
    count = int(cursor[2])
    begun = cursor[3] != 0.0
    last = cursor[4]
    status = DONE
    while k < torque.shape[0]:
        mode = mode_number(radix, digits, E)
        m = row[mode]
        if m < 0:
            status = NEED_MODE
            break
        quiet = False
        if not begun:
            for i in range(N):
                states[k, i] = s[i]
            modes[k] = mode
            if k % every == 0:
                _measure(sensors, m, s, given, k, dt * every, law_inputs)
                law_step(law, law_state, law_inputs, made, law_work)
            for i in range(law_inputs.size):
                measured[k, i] = law_inputs[i]
            for i in range(made.size):
                outputs[k + delay, i] = made[i]
            for j in range(M):
                value = outputs[k, drive[j]] if drive[j] >= 0 else given[k, -1 - drive[j]]
                if j == 0:
                    value = min(max(value, -limit), limit)
                    value = min(max(value, last - step), last + step)
                    last = value
                torque[k, j] = value
                s[N + j] = value
            quiet = _quiet(base + 8 * m * size, x, change, N, C, E, idle)
        if quiet:
            for i in range(N):
                s[i] += read(change, i)
        else:
            status, start, count = finish_sample(
                places, x, address(digits), start, k, address(events), events.shape[0], count, N, C, E, idle
            )
            if status != DONE:
                begun = True
                break
            start, begun = 0.0, False
        k += 1
    cursor[0], cursor[1], cursor[2], cursor[3], cursor[4] = k, start, count, begun, last
    if status == DONE:
        for i in range(N):
            states[k, i] = s[i]
        modes[k] = mode_number(radix, digits, E)
    return status

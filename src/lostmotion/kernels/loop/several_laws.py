"""A plant with any number of laws in the loop: of both kinds, each at its own sample time.

A sample reads the sensors, steps the laws that are due in their order, and then runs the plant exactly to the next
sample. A stepper comes as its step function, a DiscreteSystem as its tables. No fastmath: see ``law``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit, types
from numba.typed import List

from ..estimators.runner import STEP, checked_step
from ..law.step import law_step
from ..plant.entered import enter
from ..plant.event_loop import DONE, NEED_MODE, run_open_loop
from ..plant.layout import Array, Indices, mode_number

#: Status beside those of ``plant``: a signal depends on itself within one sample.
ALGEBRAIC_LOOP = 100

#: Where an input of a law comes from: the plant, a given signal, an output of a law, a torque that acts on the plant.
PLANT, GIVEN, MADE, ACTING = 0, 1, 2, 3

_POINTER = types.FunctionType(STEP)
_POINTERS = types.ListType(_POINTER)


class Laws(NamedTuple):
    """All laws' numbers one behind the other; law l has those from ``…_start[l]`` to ``…_start[l + 1]``."""

    number: Indices  # ≥ 0: the law's place among the tables, < 0: −1 − its place among the step functions
    parameters: Array  # of steppers
    parameter_start: Indices
    state: Array  # changed in place
    state_start: Indices
    input_start: Indices
    output_start: Indices
    every: Indices  # samples of the plant from one step to the next
    late: Indices  # 1: reads within the sample what it or a later law makes


class Readings(NamedTuple):
    """How each input of the laws is made, see ``closed_loop.SensorTables``."""

    kind: Indices
    at: Indices  # row of `signal`, column of `given`, output, or torque
    signal: Array  # (room, signals, C), see ``Entered``
    resolution: Array
    difference: Indices
    last: Array
    disturbance: Array


class Drive(NamedTuple):
    """Where each torque on the plant comes from."""

    output: Indices  # ≥ 0: output of a law, < 0: column −1 − output of `given`
    delay: Indices  # samples from the law's step until the torque acts
    limit: float  # of the first torque, Nm
    step: float  # largest change of the first torque from sample to sample, Nm
    slot: int  # state that is the speed of a moved end, −1: none
    speed: Array  # (n,): its value at the start of each sample, rad/s


@njit(cache=True)
def list_of_tables(first):
    """A list that holds one law's tables."""
    tables = List()
    tables.append(first)
    return tables


@njit(cache=True)
def add_tables(tables, law):
    """Puts a law's tables at the list's end."""
    tables.append(law)


@njit(_POINTERS(), cache=True)
def no_steps():
    """An empty list of step functions."""
    return List.empty_list(_POINTER)


@njit(types.void(_POINTERS, _POINTER), cache=True)
def add_step(steps, step):
    """Puts a step function at the list's end."""
    steps.append(step)


@njit(cache=True, error_model="numpy")
def _torque(drive, j, given, outputs, k, last):
    """Torque j that acts in sample k, as far as `outputs` of that sample are known."""
    source = drive.output[j]
    if source < 0:
        value = given[k, -1 - source]
    else:
        row = k - drive.delay[j]
        value = outputs[row, source] if row >= 0 else 0.0
    if j == 0:
        value = min(max(value, -drive.limit), drive.limit)
        value = min(max(value, last - drive.step), last + drive.step)
    return value


@njit(cache=True, error_model="numpy")
def _true_value(readings, i, m, s, given, outputs, drive, k, last):
    at = readings.at[i]
    if readings.kind[i] == PLANT:
        value = 0.0
        for j in range(s.size):
            value += readings.signal[m, at, j] * s[j]
        return value
    if readings.kind[i] == GIVEN:
        return given[k, at]
    if readings.kind[i] == MADE:
        return outputs[k, at]
    return _torque(drive, at, given, outputs, k, last)


@njit(cache=True, error_model="numpy")
def _quantised(readings, i, value):
    resolution = readings.resolution[i]
    return np.floor(value / resolution) * resolution if resolution > 0.0 else value


@njit(cache=True, error_model="numpy")
def _read(readings, first, stop, m, s, given, outputs, drive, k, last, dt, shown):
    """Inputs `first` to `stop` as the sensors show them; a law's own sample time is dt."""
    disturbance = readings.disturbance
    for i in range(first, stop):
        value = _quantised(readings, i, _true_value(readings, i, m, s, given, outputs, drive, k, last))
        if readings.difference[i] == 1:
            before = readings.last[i]
            value = 0.0 if np.isnan(before) else (value - before) / dt
        shown[i] = value + disturbance[k if disturbance.shape[0] > 1 else 0, i]


@njit(cache=True, error_model="numpy")
def _step_laws(
    steps,
    tables,
    laws,
    readings,
    drive,
    m,
    s,
    given,
    k,
    last,
    dt,
    measured,
    outputs,
    faults,
    trial,
    good,
):
    """All laws that are due in sample k; False if a signal depends on itself.

    A law that reads what a later one makes is stepped with the value of the sample before, then all are stepped again
    with what came out, until nothing changes: at most once for each law, and once to see that it stays.
    """
    again = False
    for law in range(laws.every.size):
        again |= k % laws.every[law] == 0 and laws.late[law] == 1
    if k > 0:
        outputs[k] = outputs[k - 1]
        measured[k] = measured[k - 1]
    settled = False
    for _ in range(laws.every.size + 2):
        changed = False
        for law in range(laws.every.size):
            if k % laws.every[law] != 0:
                continue
            a, b = laws.input_start[law], laws.input_start[law + 1]
            _read(readings, a, b, m, s, given, outputs, drive, k, last, dt * laws.every[law], measured[k])
            x, y = laws.state_start[law], laws.state_start[law + 1]
            trial[x:y] = laws.state[x:y]
            u, v = laws.output_start[law], laws.output_start[law + 1]
            made = np.empty(v - u)
            number = laws.number[law]
            if number >= 0:
                faults[k, law] = law_step(tables[number], trial[x:y], measured[k][a:b], made)
            else:
                p, q = laws.parameter_start[law], laws.parameter_start[law + 1]
                faults[k, law] = checked_step(
                    steps[-1 - number], laws.parameters[p:q], trial[x:y], measured[k][a:b], good[a:b], made
                )
            for o in range(v - u):
                old = outputs[k, u + o]
                changed |= made[o] != old and not (np.isnan(made[o]) and np.isnan(old))
                outputs[k, u + o] = made[o]
        if not again or (settled and not changed):
            return True
        settled = True
    return False


@njit(cache=True, error_model="numpy")
def _keep(laws, readings, drive, m, s, given, k, last, outputs, trial):
    """The laws' new states, and what their sensors need to remember."""
    for law in range(laws.every.size):
        if k % laws.every[law] == 0:
            x, y = laws.state_start[law], laws.state_start[law + 1]
            laws.state[x:y] = trial[x:y]
            for i in range(laws.input_start[law], laws.input_start[law + 1]):
                value = _true_value(readings, i, m, s, given, outputs, drive, k, last)
                readings.last[i] = _quantised(readings, i, value)


@njit(cache=True, error_model="numpy")
def run_mixed_loop(
    entered, s, digits, given, drive, steps, tables, laws, readings, dt, work, states, modes, torque, measured, outputs,
    faults, trial, good, events, cursor,
):  # fmt: skip
    """The plant with laws in the loop; as ``event_loop.run_open_loop``, and

    Parameters
    ----------
    entered : Entered
    given : (n, G) array
        Signals from outside.
    steps, tables : typed lists
        The steppers' step functions, see ``no_steps``; the DiscreteSystems' tables, see ``list_of_tables``.
    torque : (n, M), measured : (n, inputs), outputs : (n, outputs), faults : (n, laws)
        Filled: the torques that act in sample k, the laws' inputs at their last step, what they made then, and their
        faults.  trial, good : scratch for all states, for all inputs.
    cursor : (6,) array
        As in ``event_loop.run_open_loop``, then the set-point of the last sample, then the samples that the laws have
        done.
    """
    tb, k = entered.tables, int(cursor[0])
    while k < torque.shape[0]:
        if int(cursor[5]) <= k:
            if not enter(entered, digits):
                return NEED_MODE
            m = tb.row[mode_number(tb.radix, digits, digits.size)]
            if drive.slot >= 0:
                s[drive.slot] = drive.speed[k]
            last = cursor[4]
            if not _step_laws(
                steps, tables, laws, readings, drive, m, s, given, k, last, dt, measured, outputs, faults, trial, good,
            ):  # fmt: skip
                return ALGEBRAIC_LOOP
            _keep(laws, readings, drive, m, s, given, k, last, outputs, trial)
            for j in range(torque.shape[1]):
                torque[k, j] = _torque(drive, j, given, outputs, k, last)
            cursor[4] = torque[k, 0]
            cursor[5] = k + 1
        status = run_open_loop(tb, s, digits, torque, 0, k + 1, work, states, modes, events, cursor)
        if status == NEED_MODE and enter(entered, digits):
            continue
        if status != DONE:
            return status
        k += 1
    return DONE

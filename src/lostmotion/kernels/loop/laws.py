"""Laws in the loop: in every sample sensors, the laws that are due, and the torques that act on the plant.

There may be any number of laws of both kinds, DiscreteSystems as machine code and steppers as step functions, each
with its own sample time and delay.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba import types
from numba.typed import List

from ..estimators.runner import STEP, checked_step
from ..jit import njit
from ..law.step import step_at
from ..numerics.vectors import address, numbers_at, read, read_integer, write, write_integer
from ..plant.layout import COMPILED, Array, Indices
from .sensors import quantised, shown

#: Status beside those of ``event_loop``: a signal depends on itself within one sample (layout).
ALGEBRAIC_LOOP = 100

#: Where an input of a law comes from: the plant, a given signal, an output of a law, a torque that acts on the plant.
PLANT, GIVEN, MADE, ACTING = 0, 1, 2, 3

_POINTER = types.FunctionType(STEP)
_POINTERS = types.ListType(_POINTER)
_INNER: Any = {**COMPILED, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


class Loop(NamedTuple):
    """What happens once per sample before the plant moves: L laws with I inputs and O outputs in all, M torques.

    Law l has the inputs from ``input_start[l]`` to ``input_start[l + 1]``, and so on.
    """

    code: Indices  # (L,): address of a DiscreteSystem's step; 0: a stepper
    numbers: (
        Indices  # (L,): address of its numbers, kept alive by the caller; place of a stepper's step function
    )
    parameters: Array  # of steppers
    parameter_start: Indices
    state: Array  # changed in place
    state_start: Indices
    input_start: Indices
    output_start: Indices
    every: Indices  # (L,): samples of the plant from one step to the next
    late: Indices  # (L,): 1: reads within the sample what it or a later law makes
    kind: Indices  # (I,): PLANT, GIVEN, MADE or ACTING
    at: Indices  # (I,): signal of the plant, column of `given`, output, or torque
    exact: Indices  # (I,): 1: shows the true value
    resolution: Array  # (I,), and below, see ``sensors``
    difference: Indices
    last: Array  # (I,): what was quantised in the sample before, NaN before the first
    disturbance: (
        Array  # (n, I), or (1, I) where it is the same in every sample: noise, bias, NaN for a lost sample
    )
    driver: Indices  # (M,): ≥ 0: output that drives the torque, < 0: column −1 − driver of `given`
    delay: Indices  # (M,): samples from the law's step until the torque acts
    limits: Array  # (2,): largest first torque, Nm, and its largest change from sample to sample, Nm
    slot: int  # state that is the speed of a moved end, −1: none
    speed: Array  # (n,): its value at the start of each sample, rad/s
    given: Array  # (n, G): signals from outside
    torque: Array  # (n, M), filled: the torques that act in sample k
    measured: Array  # (n, I), filled: the laws' inputs at their last step
    outputs: Array  # (n, O), filled: what the laws made then
    faults: Indices  # (n, L), filled: bit masks of the inputs that were bad; zeros at first
    trial: Array  # scratch: as `state`, `last` and a row of `outputs`
    now: Array
    made: Array
    good: Array  # scratch, (I,)
    dt: float  # of the plant, s


class _Places(NamedTuple):
    """Addresses and sizes of all that: handed on as arrays, their counted references would cost more."""

    code: int
    numbers: int
    parameters: int
    parameter_start: int
    state: int
    state_start: int
    input_start: int
    output_start: int
    every: int
    late: int
    kind: int
    at: int
    exact: int
    resolution: int
    difference: int
    last: int
    disturbance: int
    disturbance_row: int
    driver: int
    delay: int
    limit: float
    step: float
    given: int
    given_row: int
    torque: int
    measured: int
    outputs: int
    faults: int
    trial: int
    now: int
    made: int
    good: int
    dt: float
    laws: int
    n_inputs: int
    n_outputs: int
    n_torques: int
    signal: int
    span: int
    signals: int
    columns: int
    alone: bool  # one law, due in every sample, that reads nothing of its own
    only_code: int
    only_numbers: int


@njit(inline="always", **COMPILED)
def loop_places(entered, x):
    disturbance_row = 0
    if x.disturbance.shape[0] > 1:
        disturbance_row = x.disturbance.shape[1]
    alone = x.code.size == 1 and x.every[0] == 1 and x.late[0] == 0
    code, numbers = 0, 0
    if x.code.size > 0:
        code, numbers = x.code[0], x.numbers[0]
    return _Places(
        address(x.code), address(x.numbers), address(x.parameters), address(x.parameter_start), address(x.state),
        address(x.state_start), address(x.input_start), address(x.output_start), address(x.every), address(x.late),
        address(x.kind), address(x.at), address(x.exact), address(x.resolution), address(x.difference),
        address(x.last), address(x.disturbance), disturbance_row, address(x.driver), address(x.delay),
        x.limits[0], x.limits[1], address(x.given), x.given.shape[1], address(x.torque), address(x.measured),
        address(x.outputs), address(x.faults), address(x.trial), address(x.now),
        address(x.made), address(x.good), x.dt, x.code.size, x.measured.shape[1], x.outputs.shape[1],
        x.torque.shape[1], address(entered.signal), address(entered.span), entered.signal.shape[1],
        entered.signal.shape[2], alone, code, numbers,
    )  # fmt: skip


@njit(_POINTERS(), cache=True)
def no_steps():
    """An empty list of step functions."""
    return List.empty_list(_POINTER)


@njit(types.void(_POINTERS, _POINTER), cache=True)
def add_step(steps, step):
    """Puts a step function at the list's end."""
    steps.append(step)


@njit(inline="always", **_INNER)
def _torque(p, j, k, last):
    """Torque j that acts in sample k, as far as the outputs of that sample are known."""
    driver = read_integer(p.driver, j)
    row = k - read_integer(p.delay, j)
    if driver < 0:
        value = read(p.given, k * p.given_row - 1 - driver)
    else:
        value = read(p.outputs, row * p.n_outputs + driver) if row >= 0 else 0.0
    if j == 0:
        value = min(max(value, -p.limit), p.limit)
        value = min(max(value, last - p.step), last + p.step)
    return value


@njit(inline="always", **_INNER)
def _true_value(p, i, m, s, k, last):
    kind, at = read_integer(p.kind, i), read_integer(p.at, i)
    if kind == PLANT:
        place = m * p.signals + at
        value = 0.0
        for j in range(read_integer(p.span, 2 * place), read_integer(p.span, 2 * place + 1)):
            value += read(p.signal, place * p.columns + j) * read(s, j)
        return value
    if kind == GIVEN:
        return read(p.given, k * p.given_row + at)
    if kind == MADE:
        return read(p.outputs, k * p.n_outputs + at)
    return _torque(p, at, k, last)


@njit(**_INNER)
def _step_stepper(p, steps, law, state, inputs, outputs):
    a, b = read_integer(p.parameter_start, law), read_integer(p.parameter_start, law + 1)
    x = read_integer(p.state_start, law + 1) - read_integer(p.state_start, law)
    first = read_integer(p.input_start, law)
    u = read_integer(p.input_start, law + 1) - first
    y = read_integer(p.output_start, law + 1) - read_integer(p.output_start, law)
    return checked_step(
        steps[read_integer(p.numbers, law)], numbers_at(p.parameters + 8 * a, b - a), numbers_at(state, x),
        numbers_at(inputs, u), numbers_at(p.good + 8 * first, u), numbers_at(outputs, y),
    )  # fmt: skip


@njit(inline="always", **_INNER)
def _measure_and_step(p, steps, law, code, numbers, first, stop, m, s, k, last, state, made, now):
    """Sensors and step of one law with the inputs `first` to `stop`.

    state, made: addresses of its state and outputs; now: of all laws' quantised inputs.
    """
    measured = p.measured + 8 * k * p.n_inputs
    for i in range(first, stop):
        value = _true_value(p, i, m, s, k, last)
        if read_integer(p.exact, i) == 0:
            value, before = quantised(value, read(p.resolution, i)), read(p.last, i)
            write(now, i, value)
            value = shown(
                value, before, read_integer(p.difference, i), p.dt * read_integer(p.every, law),
                read(p.disturbance, k * p.disturbance_row + i),
            )  # fmt: skip
        write(measured, i, value)
    if code != 0:
        bad = step_at(code, numbers, state, measured + 8 * first, made)
    else:
        bad = _step_stepper(p, steps, law, state, measured + 8 * first, made)
    write_integer(p.faults, k * p.laws + law, bad)


@njit(forceinline=True, **_INNER)
def _step_law(p, steps, law, m, s, k, last, states, outputs, now):
    """One of several laws; states, outputs: addresses of those of all laws."""
    _measure_and_step(
        p, steps, law, read_integer(p.code, law), read_integer(p.numbers, law), read_integer(p.input_start, law),
        read_integer(p.input_start, law + 1), m, s, k, last, states + 8 * read_integer(p.state_start, law),
        outputs + 8 * read_integer(p.output_start, law), now,
    )  # fmt: skip


@njit(forceinline=True, **_INNER)
def _hold(p, law, k):
    """What a law that is not due measured and made in the sample before."""
    for i in range(read_integer(p.input_start, law), read_integer(p.input_start, law + 1)):
        write(p.measured, k * p.n_inputs + i, read(p.measured, (k - 1) * p.n_inputs + i))
    for i in range(read_integer(p.output_start, law), read_integer(p.output_start, law + 1)):
        write(p.outputs, k * p.n_outputs + i, read(p.outputs, (k - 1) * p.n_outputs + i))


@njit(**_INNER)
def _settle(p, steps, m, s, k, last):
    """All laws that are due, where one reads what a later one makes; False if a signal depends on itself.

    They are stepped with the outputs of the sample before, then again with what came out, until nothing changes: at
    most once for each law, and once to see that it stays.
    """
    outputs = p.outputs + 8 * k * p.n_outputs
    for i in range(p.n_outputs):
        write(outputs, i, read(outputs, i - p.n_outputs) if k > 0 else 0.0)
    settled = False
    for turn in range(p.laws + 2):
        changed = False
        for law in range(p.laws):
            if k % read_integer(p.every, law) != 0:
                continue
            for i in range(read_integer(p.state_start, law), read_integer(p.state_start, law + 1)):
                write(p.trial, i, read(p.state, i))
            _step_law(p, steps, law, m, s, k, last, p.trial, p.made, p.now)
            for i in range(read_integer(p.output_start, law), read_integer(p.output_start, law + 1)):
                new, old = read(p.made, i), read(outputs, i)
                changed |= new != old and not (new != new and old != old)
                write(outputs, i, new)
        settled = turn > 0 and not changed
        if settled:
            break
    for law in range(p.laws):
        if k % read_integer(p.every, law) == 0:
            for i in range(read_integer(p.state_start, law), read_integer(p.state_start, law + 1)):
                write(p.state, i, read(p.trial, i))
            for i in range(read_integer(p.input_start, law), read_integer(p.input_start, law + 1)):
                if read_integer(p.exact, i) == 0:
                    write(p.last, i, read(p.now, i))
    return settled


@njit(inline="always", **COMPILED)
def control(p, steps, m, s, k, last):
    """Sensors, laws and torques of sample k, these also to s; False if a signal depends on itself, the first torque.

    m: row of the contact state; s: address of [x, v, 1]; last: the first torque of the sample before.
    """
    settled, again, outputs = True, False, p.outputs + 8 * k * p.n_outputs
    if p.alone:
        # As most loops; its numbers stay in registers.
        _measure_and_step(
            p, steps, 0, p.only_code, p.only_numbers, 0, p.n_inputs, m, s, k, last, p.state, outputs, p.last
        )
    else:
        for law in range(p.laws):
            every = read_integer(p.every, law)
            if every == 1 or k % every == 0:
                again = again or read_integer(p.late, law) == 1
            else:
                _hold(p, law, k)
        if again:
            settled = _settle(p, steps, m, s, k, last)
        else:
            for law in range(p.laws):
                if k % read_integer(p.every, law) == 0:
                    _step_law(p, steps, law, m, s, k, last, p.state, outputs, p.last)
    first = last
    for j in range(p.n_torques):
        value = _torque(p, j, k, last)
        if j == 0:
            first = value
        write(p.torque, k * p.n_torques + j, value)
        write(s, p.columns - 1 - p.n_torques + j, value)
    return settled, first

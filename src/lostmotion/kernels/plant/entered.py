"""The contact states that a run has entered: each is built once, and the kernels find it by its number."""

from __future__ import annotations

from typing import Any, NamedTuple

from ..jit import njit
from .contact_states import ModeWork, build_mode
from .equations import Chain
from .layout import Array, Indices, PlantTables, mode_number

_COMPILED: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True}


class Entered(NamedTuple):
    """Tables of the contact states entered so far, and room for more; what builds them."""

    tables: PlantTables
    chain: Chain
    numbers: Array  # (P,): the drivetrain's, see ``equations.Chain``
    weights: Array  # (signals, C + n − 1): signals over [x, inputs, 1] and the shafts' torques
    work: ModeWork
    rows: Array  # (room, R, C): of each contact state, see ``ModeWork``
    digits: Indices  # (room, E)
    signal: Array  # (room, signals, C): the signals' rows in each contact state
    span: Indices  # (room, signals, 2): their first column that is not zero, and the one after the last
    built: Indices  # (1,): how many were entered
    size: int  # of a contact state's block in `tables.flat`


@njit(**_COMPILED)
def enter(entered, digits):
    """Builds the contact state of these digits if it does not stand yet; False where there is no room for it."""
    tables, slot = entered.tables, entered.built[0]
    mode = mode_number(tables.radix, digits, digits.size)
    if tables.row[mode] >= 0:
        return True
    if slot == entered.rows.shape[0]:
        return False
    work, rows = entered.work, entered.rows[slot]
    build_mode(
        entered.chain, entered.numbers, digits, tables.flat, slot * entered.size,
        work.rows, work.bounds, work.weights, work.scratch,
    )  # fmt: skip
    for i in range(rows.shape[0]):
        for j in range(rows.shape[1]):
            rows[i, j] = work.rows[i, j]
    for e in range(digits.size):
        entered.digits[slot, e] = digits[e]
    _signal_rows(entered.weights, rows, entered.signal[slot], entered.span[slot])
    tables.row[mode] = slot
    entered.built[0] = slot + 1
    return True


@njit(**_COMPILED)
def _signal_rows(weights, torques, signal, span):
    """Rows of the signals where the shafts' torques have the first rows of `torques`."""
    columns = signal.shape[1]
    for i in range(signal.shape[0]):
        first, stop = columns, 0
        for j in range(columns):
            value = weights[i, j]
            for m in range(weights.shape[1] - columns):
                value += weights[i, columns + m] * torques[m, j]
            signal[i, j] = value
            if value != 0.0:
                first, stop = min(first, j), j + 1
        span[i, 0], span[i, 1] = min(first, stop), stop

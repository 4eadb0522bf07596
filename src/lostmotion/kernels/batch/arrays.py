"""What a batch of variants works on: what they share, what each of them leaves, and the arrays of one thread."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..numerics.vectors import LANES
from ..plant.equations import Chain
from ..plant.event_loop import EVENT_COLUMNS
from ..plant.layout import Array, Indices, new_work

#: Samples in a block (numerics: 48 kB of states and sums for two masses).
BLOCK = 512
#: Events that a block may hold before they are counted (numerics).
EVENT_SPACE = 64


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
    digits: Indices  # (E,), or (0,): given by the start
    last: float  # torque set-point before the first sample, Nm
    signal: Array  # (S, C + n − 1)
    state: Indices  # (S,)
    sampled: Indices  # (Q,): signals kept at every `step`-th sample
    step: int


class Summary(NamedTuple):
    """Filled by ``batch.run_variants``, one row for each variant."""

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

"""Cost of a plan: moves of a torque, each held for some samples, over one or several phases of a linear plant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Phase:
    """x⁺ = A x + B·torque at the cost |rows·x⁺|² per sample, for moves of so many samples."""

    A: Array
    B: Array
    rows: Array
    lengths: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Plan:
    """½·Uᵀ hessian U + (state_gradient·x)ᵀ U + ½·xᵀ state_cost x: the cost of moves U (m,) from the state x (n,), as
    differences from the steady state; the move i lasts ``lengths[i]`` samples. After k samples the state is
    ``free[k]``·x + ``forced[k]``·U."""

    lengths: tuple[int, ...]
    hessian: Array
    state_gradient: Array
    state_cost: Array
    free: Array
    forced: Array


def plan_cost(phases: Sequence[Phase], torque_weight: float, last: Array) -> Plan:
    """Cost of Σ |rows·x|² + torque_weight·u² over the moves of all phases; in the last sample ``last`` takes the place
    of the rows: the cost of all that follows."""
    lengths = tuple(length for phase in phases for length in phase.lengths)
    n, m = last.shape[0], len(lengths)
    # x after so many samples = free·x + forced·U
    free, forced = np.eye(n), np.zeros((n, m))
    hessian, gradient, cost = np.zeros((m, m)), np.zeros((m, n)), np.zeros((n, n))
    path, move = [(free, forced)], 0
    for phase in phases:
        q = phase.rows.T @ phase.rows
        for length in phase.lengths:
            for _ in range(length):
                free, forced = phase.A @ free, phase.A @ forced
                forced[:, move] += phase.B
                hessian += forced.T @ q @ forced
                gradient += forced.T @ q @ free
                cost += free.T @ q @ free
                hessian[move, move] += torque_weight
                path.append((free, forced))
            move += 1
    rest = last - q
    hessian += forced.T @ rest @ forced
    gradient += forced.T @ rest @ free
    cost += free.T @ rest @ free
    return Plan(
        lengths, 0.5 * (hessian + hessian.T), gradient, 0.5 * (cost + cost.T),
        np.array([state[0] for state in path]), np.array([state[1] for state in path]),
    )  # fmt: skip


def move_lengths(horizon: int, moves: int) -> tuple[int, ...]:
    """Lengths (samples) of so many moves that fill the horizon, growing like a geometric series from one sample on."""
    ends = np.unique(
        np.maximum.accumulate(np.round(np.geomspace(1.0, max(horizon, moves), moves)).astype(int))
    )
    ends = np.maximum(ends, np.arange(1, ends.size + 1))
    return tuple(int(length) for length in np.diff(ends, prepend=0))

"""Where the loop rests at a load speed: exactly, with the set-point that leads there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import islice, product

import numpy as np

from .lure import LureLoop
from .rational import Matrix, rational, solve, zeros
from .static_curves import StaticCurve

#: Rounds in which the segments of all curves must have been found, and first guesses of them (numerics: each curve has
#: a few segments, and the outermost is nearly always right).
ROUNDS, GUESSES = 20, 81


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """The loop at rest: state (n,), curve arguments (plant, then law), segments, reference; all exact.

    ``speed`` of the load in rad/s, ``torque_load`` in Nm.
    """

    speed: Fraction
    torque_load: Fraction
    state: Matrix
    reference: Fraction
    arguments: tuple[Fraction, ...]
    segments: tuple[int, ...]


def equilibrium(loop: LureLoop, speed: Fraction, torque_load: Fraction = Fraction(0)) -> Equilibrium | None:
    """The rest of the loop with the load at ``speed`` ≠ 0; None where there is none, or more than one.

    docs/proofs.md, equations 3 and 4. Each curve is a straight line on its segment, so the rest is the solution of a
    linear system; the segments are guessed, then read off the solution until nothing changes.
    """
    curves = (*loop.plant_curves, *loop.law_curves)
    orders = [
        range(len(curve.points), -1, -1) if speed > 0 else range(len(curve.points) + 1) for curve in curves
    ]
    plant = tuple(order[0] for order in orders[: len(loop.plant_curves)])
    for guess in islice(product(*orders[len(plant) :]), GUESSES):
        found = _from_guess(loop, curves, (*plant, *guess), speed, torque_load)
        if found is not None:
            return found
    return None


def _from_guess(
    loop: LureLoop,
    curves: Sequence[StaticCurve],
    segments: Sequence[int],
    speed: Fraction,
    torque_load: Fraction,
) -> Equilibrium | None:
    """The rest that the segments lead to, if they lead to one."""
    for _ in range(ROUNDS):
        found = _at_segments(loop, segments, speed, torque_load)
        if found is None:
            return None
        state, arguments, reference = found
        read = [curve.segment(z) for curve, z in zip(curves, arguments, strict=True)]
        if read == list(segments):
            return Equilibrium(speed, torque_load, state, reference, tuple(arguments), tuple(segments))
        if None in read:
            return None  # on a corner: no sector there
        segments = [segment for segment in read if segment is not None]
    return None


def _at_segments(
    loop: LureLoop, segments: Sequence[int], speed: Fraction, torque_load: Fraction
) -> tuple[Matrix, list[Fraction], Fraction] | None:
    """State, curve arguments and reference, with every curve continued along one of its segments."""
    solved = _affine(loop, tuple(segments))
    if solved is None:
        return None
    rest, arguments = solved
    given = rational([1, speed, torque_load])
    found = rest @ given
    return found[: len(loop.states)], list(arguments @ given), found[-1]


@lru_cache(maxsize=64)
def _affine(loop: LureLoop, segments: tuple[int, ...]) -> tuple[Matrix, Matrix] | None:
    """The rest, (n + p + q + 1, 3), and the curves' arguments, (p + q, 3), over 1, speed and load torque.

    On its segments the loop is linear, so its rest is affine: one system is solved for all speeds (equations 4 and 6).
    """
    n, p, q = len(loop.states), len(loop.plant_curves), len(loop.law_curves)
    curves = (*loop.plant_curves, *loop.law_curves)
    # Columns: ξ, w, v, reference.
    size = n + p + q + 1
    rows, right = zeros(size, size), zeros(size, 3)
    plant = loop.plant_size
    rows[:plant, :n], rows[:plant, n : n + p] = loop.A[:plant], loop.E[:plant]
    rows[:plant, -1:] = loop.R[:plant]
    right[:plant, 2] = -loop.L[:plant, 0]
    jump = np.hstack([loop.S, loop.S_w, loop.S_v, loop.R])[plant:]
    rows[plant:n] = jump
    rows[plant:n, :n] -= rational(np.eye(n))[plant:]
    arguments = zeros(p + q, size)
    arguments[:p, :n] = loop.Z
    arguments[p:] = np.hstack([loop.N, loop.N_w, loop.N_v, loop.M])
    for i, (curve, segment) in enumerate(zip(curves, segments, strict=True)):
        if curve.slopes[segment] is None:
            return None
        value, slope = curve.line(segment)
        rows[n + i] = -slope * arguments[i]
        rows[n + i, n + i] += 1
        right[n + i, 0] = value
    rows[-1, loop.states.index("speed_load")] = Fraction(1)
    right[-1, 1] = Fraction(1)
    solution = solve(rows, right)
    return None if solution is None else (solution, arguments @ solution)

"""A loop as peak bounds see it: without the torque limit, and with the signals whose peaks are asked for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ...drivetrain import Drivetrain
from ...systems import DiscreteSystem
from ..continuous.continuous_law import ContinuousLaw
from ..continuous.continuous_loop import continuous_loop
from ..lure import LureLoop, largest_torque, lure_loop
from ..plant import plant_of
from ..rational import Matrix, identity, zeros
from .curve_relations import CurveShape, shape_of
from .level_set import Output, inner_curves

#: The signals of a result, the first three of them states of the plant.
STATES = ("twist", "speed_motor", "speed_load")


class Asked(NamedTuple):
    """A signal whose peak is asked for; beside ``output`` so much is added by jumps, and by each rad/s of set-point."""

    output: Output
    by_jumps: Fraction
    by_reference: Fraction


@dataclass(frozen=True, eq=False)
class PeakLoop:
    """The loop without torque limit.

    Parameters
    ----------
    loop : LureLoop
    sampled : bool
    shapes : tuple of CurveShape
        Plant curves, then law curves.
    asked : mapping of name → Asked
        Those of a result, and the arguments of all curves.
    arguments : tuple of str
        For each curve the name of its argument.
    limit : float, Nm
        The torque limit that was left out; inf if there is none.
    """

    loop: LureLoop
    sampled: bool
    shapes: tuple[CurveShape, ...]
    asked: dict[str, Asked]
    arguments: tuple[str, ...]
    limit: float


def continuous_peak_loop(drivetrain: Drivetrain, law: ContinuousLaw, limit: float) -> PeakLoop:
    """The loop of a law in continuous time; drivetrain without lag and torque limit."""
    loop = continuous_loop(drivetrain, law)
    plant, inertia = plant_of(drivetrain), Fraction(drivetrain.inertia_motor)
    # The motor torque is what the law adds to the motor's momentum.
    state, curve = inertia * loop.A[1], inertia * loop.E[1]
    state[: len(plant.states)] -= inertia * plant.A[1]
    curve[: len(plant.curves)] -= inertia * plant.E[1]
    row = np.concatenate([state, curve])
    return _peak_loop(loop, row, inertia * loop.R[1, 0], limit, sampled=False)


def sampled_peak_loop(drivetrain: Drivetrain, law: DiscreteSystem, delay: int) -> PeakLoop:
    """The loop of a sampled law."""
    loop = lure_loop(drivetrain, law, delay=delay)
    limit, held = largest_torque(drivetrain, law), loop.plant_size
    if loop.limit is not None:
        loop = _without_limit(loop, loop.limit)
    row = np.concatenate([loop.S[held], loop.S_w[held], loop.S_v[held]])
    return _peak_loop(loop, row, loop.R[held, 0], limit, sampled=True)


def _peak_loop(loop: LureLoop, torque: Matrix, given: Fraction, limit: float, *, sampled: bool) -> PeakLoop:
    """``torque``: the motor torque's row over states and curves; ``given``: its share of the set-point."""
    loop, torque = _with_errors(loop, torque)
    n, p = len(loop.states), len(loop.plant_curves)
    curves = (*loop.plant_curves, *loop.law_curves)
    shapes = tuple(shape_of(curve, name) for curve, name in zip(curves, loop.names, strict=True))
    inner = inner_curves(loop.N_v, loop.M)
    apart = [i for i, s in enumerate(shapes) if s.steepest is None or (i >= p and i - p not in inner)]

    def signal(row: Matrix, given: Fraction = Fraction(0), before_sample: bool = False) -> Asked:
        """Curves of ``apart`` are left out of a row: they are bounded by their heights."""
        kept, by_jumps = row.copy(), Fraction(0)
        for i in apart:
            if n + i < row.size:
                by_jumps += abs(row[n + i]) * shapes[i].high
                kept[n + i] = Fraction(0)
        return Asked(Output(kept, before_sample), by_jumps, abs(given))

    unit, none = identity(n), zeros(p)
    asked = {name: signal(np.concatenate([unit[i], none])) for i, name in enumerate(STATES)}
    asked["torque_motor"] = signal(torque, given, sampled)
    arguments = [signal(np.concatenate([row, none])) for row in loop.Z]
    if sampled:
        rows = np.hstack([loop.N, loop.N_w, loop.N_v])
        arguments += [signal(row, loop.M[j, 0], before_sample=True) for j, row in enumerate(rows)]
    names = [
        _named(asked, f"argument of {name}", own) for name, own in zip(loop.names, arguments, strict=True)
    ]
    return PeakLoop(loop, sampled, shapes, asked, tuple(names), limit)


def _with_errors(loop: LureLoop, row: Matrix) -> tuple[LureLoop, Matrix]:
    """The loop, and a row over its states and curves, with the errors of an observer in place of its estimates.

    The set-point moves drivetrain and estimate alike: the level sets are flat in the direction of the errors, and in
    the estimates' own coordinates the solver does not see how flat.
    """
    n = len(loop.states)
    to, back = identity(n), identity(n)
    for i, name in enumerate(loop.states):
        own = name.removeprefix("law: ")
        if own != name and own in loop.states:
            to[i, loop.states.index(own)] -= 1
            back[i, loop.states.index(own)] += 1
    changed = replace(
        loop, A=to @ loop.A @ back, E=to @ loop.E, L=to @ loop.L, R=to @ loop.R, Z=loop.Z @ back,
        S=to @ loop.S @ back, S_w=to @ loop.S_w, S_v=to @ loop.S_v, N=loop.N @ back,
    )  # fmt: skip
    return changed, np.concatenate([row[:n] @ back, row[n:]])


def _named(asked: dict[str, Asked], name: str, own: Asked) -> str:
    """The name of a signal like this one, which is added if there is none."""
    for other, known in asked.items():
        same = known.output.before_sample == own.output.before_sample and known[1:] == own[1:]
        if same and np.array_equal(known.output.row, own.output.row):
            return other
    asked[name] = own
    return name


def _without_limit(loop: LureLoop, limit: int) -> LureLoop:
    """The loop with its torque limit's curve replaced by its slope around zero."""
    slope = loop.law_curves[limit].steepest
    kept = [j for j in range(len(loop.law_curves)) if j != limit]
    by_state, by_law = slope * loop.S_v[:, [limit]], slope * loop.N_v[kept][:, [limit]]
    p = len(loop.plant_curves)
    return replace(
        loop,
        S=loop.S + by_state @ loop.N[[limit]], S_w=loop.S_w + by_state @ loop.N_w[[limit]],
        S_v=(loop.S_v + by_state @ loop.N_v[[limit]])[:, kept], R=loop.R + by_state @ loop.M[[limit]],
        N=loop.N[kept] + by_law @ loop.N[[limit]], N_w=loop.N_w[kept] + by_law @ loop.N_w[[limit]],
        N_v=(loop.N_v[kept] + by_law @ loop.N_v[[limit]])[:, kept], M=loop.M[kept] + by_law @ loop.M[[limit]],
        law_curves=tuple(loop.law_curves[j] for j in kept),
        names=(*loop.names[:p], *(loop.names[p + j] for j in kept)), limit=None,
    )  # fmt: skip

"""The linear loop of each contact state: gap closed or open, load running or held by its friction."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...curves import PiecewiseLinear
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem, pruned
from ..equilibrium import equilibrium
from ..lure import LureLoop, lure_loop
from ..rational import Matrix, zeros
from ..static_curves import StaticCurve
from .open_loop import OpenLoop

GAP, LOAD = "gap", "friction of the load"


def contact_loops(
    drivetrain: Drivetrain, law: DiscreteSystem, *, delay: int, speed: float, torque_load: float
) -> dict[str, OpenLoop]:
    """The loop in each contact state that the drivetrain can be in, opened at the motor torque.

    Running: every curve of plant and law has its slope at the rest with that load speed; in the open gap, the gap
    curves have that of the gap. Standing: the load is held, and the law's other curves have their slope at zero. States
    that the torque does not move, or that it does not hang on, are left out: the twist in the open gap is one.

    Raises
    ------
    InvalidInput
        As ``lure_loop``, and where the loop does not rest at that speed.
    """
    loop = lure_loop(drivetrain, law, delay=delay)
    rest = equilibrium(loop, Fraction(speed), Fraction(torque_load))
    if rest is None:
        raise InvalidInput(
            "margins.speed", f"{speed:g} rad/s", "a load speed at which the loop rests", "Take a larger one."
        )
    curves = (*loop.plant_curves, *loop.law_curves)
    running = [_slope(curve, segment) for curve, segment in zip(curves, rest.segments, strict=True)]
    gaps = [i for i, name in enumerate(loop.names) if name == GAP]
    gaps += [len(loop.plant_curves) + j for j in _dead_zones(law)]
    found = {"running, gap closed": _opened(loop, running)}
    if drivetrain.shaft.has_backlash:
        found["running, gap open"] = _opened(loop, _with(running, curves, gaps))
    if LOAD in loop.names:
        standing = list(running)
        for i in sorted(set(range(len(loop.plant_curves), len(curves))) - set(gaps)):
            standing[i] = _slope(curves[i], _beside_zero(curves[i]))
        found["load held, gap closed"] = _opened(loop, standing, held=True)
        if drivetrain.shaft.has_backlash:
            found["load held, gap open"] = _opened(loop, _with(standing, curves, gaps), held=True)
    return found


def _dead_zones(law: DiscreteSystem) -> list[int]:
    """Which of the law's curves are gaps: zero slope between two equal ones."""

    def is_gap(curve: PiecewiseLinear) -> bool:
        left, *inner, right = curve.slopes
        return inner == [0.0] and left == right != 0.0

    return [j for j, curve in enumerate(pruned(law, ("torque_motor",)).curves) if is_gap(curve)]


def _slope(curve: StaticCurve, segment: int) -> Fraction:
    slope = curve.slopes[segment]
    if slope is None:
        raise ValueError("a jump has no slope")
    return slope


def _beside_zero(curve: StaticCurve) -> int:
    """The segment right of zero."""
    return sum(z <= 0 for z, _ in curve.points)


def _with(slopes: list[Fraction], curves: tuple[StaticCurve, ...], open_gaps: list[int]) -> list[Fraction]:
    """The slopes with those of the open gap: of the curve's middle segment."""
    changed = list(slopes)
    for i in open_gaps:
        changed[i] = _slope(curves[i], 1)
    return changed


def _opened(loop: LureLoop, slopes: list[Fraction], held: bool = False) -> OpenLoop:
    """The loop with each curve a slope times its argument, in fractions; of it what the torque moves and hangs on."""
    p, q, n = len(loop.plant_curves), len(loop.law_curves), loop.plant_size
    w = np.array(slopes[:p], dtype=object)[:, np.newaxis] * loop.Z
    v = zeros(q, len(loop.states))
    for j in range(q):
        v[j] = slopes[p + j] * (loop.N[j] + loop.N_w[j] @ w + loop.N_v[j] @ v)
    flow, jump = loop.A + loop.E @ w, loop.S + loop.S_w @ w + loop.S_v @ v
    if held:
        flow[loop.states.index("speed_load")] = Fraction(0)
    both = np.vstack([flow[:n], jump[n:]])
    kept = np.flatnonzero(_reached(both, n) & _reached(both.T, n))
    x, c = [int(i) for i in kept if i < n], [int(i) for i in kept if i > n]

    def part(matrix: Matrix, rows: list[int], columns: list[int]) -> np.ndarray:
        return np.asarray(matrix[np.ix_(rows, columns)], dtype=float)

    return OpenLoop(
        A=part(flow, x, x), B=part(flow, x, [n]), reading=part(jump, c, x), law=part(jump, c, c),
        of_plant=part(jump, [n], x)[0], of_law=part(jump, [n], c)[0], dt=float(loop.dt),
    )  # fmt: skip


def _reached(matrix: Matrix, start: int) -> np.ndarray:
    """Which states hang on the first one, directly or through others."""
    links = matrix != 0
    known = np.zeros(len(matrix), dtype=bool)
    known[start] = True
    while True:
        more = known | np.any(links[:, known], axis=1)
        if np.array_equal(more, known):
            return known
        known = more

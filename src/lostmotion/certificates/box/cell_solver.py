"""The search for the numbers that prove one cell: rests, sectors, inequalities, solver."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...drivetrain import Drivetrain
from ..certificate import short
from ..equilibrium import Equilibrium, equilibrium
from ..lure import LureLoop
from ..running import Unproved
from ..sampled_proof import sampled_proof
from ..scaling import condition_sizes, state_sizes
from ..sectors import Sector, copies, limit_region
from ..semidefinite import Inequalities, Unknowns
from .cell import Cell, CellProof, LoopOf, flow_corners, in_torque, rest_corners, scaled, with_flows_of


@dataclass(frozen=True, eq=False)
class CellClaim:
    """What is to be proved of every drivetrain in a cell.

    Parameters
    ----------
    drivetrain : Drivetrain
        The nominal one.
    loop_of : callable
        The loop of a drivetrain with the law.
    speeds, torque_load : (float, float)
        Range of load speeds at rest (rad/s) and of constant load torques (Nm).
    continuous : bool
        Whether the law acts in continuous time.
    substeps : int
    step, share : float
        See ``running``: where the torque limit keeps the proof from holding from every state; step None: it does not.
    """

    drivetrain: Drivetrain
    loop_of: LoopOf
    speeds: tuple[float, float]
    torque_load: tuple[float, float] = (0.0, 0.0)
    continuous: bool = False
    substeps: int = 1
    step: float | None = None
    share: float = 1.0

    def loop(self, cell: Cell, shares: dict[str, float]) -> LureLoop:
        """The loop of a drivetrain in the cell, in units of torque unless the cell is a point."""
        drivetrain = scaled(self.drivetrain, shares)
        loop = self.loop_of(drivetrain)
        return in_torque(loop, drivetrain) if cell else loop


@dataclass(frozen=True, eq=False)
class CellSolution:
    """Numbers that satisfy the inequalities of a cell in floats, with their margin, and the segments at rest."""

    proof: CellProof
    unknowns: Unknowns
    segments: tuple[int, ...]
    margin: float


def solve_cell(claim: CellClaim, cell: Cell) -> CellSolution:
    """The numbers of one cell; raises ``Unproved`` if the solver finds none."""
    known = [
        (loop, rest)
        for loop in (claim.loop(cell, corner) for corner in rest_corners(cell))
        for rest in _rests(loop, claim)
    ]
    bounds = _sectors(known)
    loop, first = known[0]
    pairs = copies(loop, [rest for _, rest in known])
    if cell:  # the gap of the drivetrain is not the law's
        pairs = tuple(c for c in pairs if loop.names[c.first].startswith("law: "))
    region = None
    if claim.step is not None:
        region, bounds = limit_region(
            loop, [rest for _, rest in known], bounds, Fraction(claim.step), Fraction(claim.share)
        )
    problem = sampled_proof(loop, first, bounds, pairs, claim.substeps, region)
    flows = with_flows_of(problem, [claim.loop(cell, corner) for corner in flow_corners(cell)])
    return _solved(CellProof(flows, cell, claim.continuous), first.segments)


def _rests(loop: LureLoop, claim: CellClaim) -> list[Equilibrium]:
    found = [
        equilibrium(loop, Fraction(r), Fraction(m))
        for m in sorted(set(claim.torque_load))
        for r in sorted(set(claim.speeds))
    ]
    known = [rest for rest in found if rest is not None]
    if len(known) < len(found):
        raise Unproved("the loop has no single equilibrium there")
    return known


def _sectors(rests: Sequence[tuple[LureLoop, Equilibrium]]) -> tuple[Sector, ...]:
    """The widest sector of each curve over all rests."""
    if len({rest.segments for _, rest in rests}) != 1:
        raise Unproved("a curve rests on different segments within the cell")
    found = []
    for i in range(len(rests[0][1].arguments)):
        each = [(*loop.plant_curves, *loop.law_curves)[i].sector(rest.arguments[i]) for loop, rest in rests]
        found.append(Sector(min(low for low, _ in each), max(high for _, high in each)))
    return tuple(found)


def _solved(proof: CellProof, segments: tuple[int, ...]) -> CellSolution:
    # The corners differ little: the first one's sizes scale them all, and the solver finds out what is unstable.
    sizes = state_sizes(proof.proofs[0])
    if sizes is None:
        raise Unproved("the loop is not stable where it rests, in contact and slipping")
    scales = proof.sizes(condition_sizes(proof.proofs[0], sizes))
    found = Inequalities(proof.conditions, proof.layout, scales).largest_margin()
    if found is None:
        raise Unproved("the solver found no numbers")
    unknowns = {name: short(value) for name, value in found[0].items()}
    for scale, matrix in zip(scales, proof.conditions(unknowns), strict=True):
        if not np.linalg.eigvalsh(matrix * np.outer(scale, scale))[0] > 0.0:
            raise Unproved("the inequalities have no solution that the solver finds")
    return CellSolution(proof, unknowns, segments, found[1])

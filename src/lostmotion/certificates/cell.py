"""A cell of a box of drivetrains: one V, or one family of V, that proves the loop with every drivetrain in the cell.

In units of torque the parameters enter the flow alone, and each only once: docs/stability.md, equations 20 to 22.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product

import numpy as np

from ..drivetrain import Drivetrain, Friction
from .lure import LureLoop
from .rational import Matrix, identity, rational
from .sampled_proof import SampledProof
from .semidefinite import Layout, Unknowns
from .static_curves import StaticCurve

#: Parameters that a box may vary; each is a share of its nominal value.
PARAMETERS = ("inertia_load", "stiffness", "coulomb", "backlash", "inertia_motor")

#: Smallest and largest share of each parameter; what is left out keeps its nominal value.
Cell = Mapping[str, tuple[float, float]]

#: The loop of a drivetrain with the law of the proof.
LoopOf = Callable[[Drivetrain], LureLoop]


def scaled(drivetrain: Drivetrain, shares: Mapping[str, float]) -> Drivetrain:
    """The drivetrain with parameters multiplied; ``coulomb``: all levels of friction of motor and load."""
    of = {name: shares.get(name, 1.0) for name in PARAMETERS}
    motor, load = drivetrain.inertias
    shaft = drivetrain.shaft
    return replace(
        drivetrain,
        inertias=(motor * of["inertia_motor"], load * of["inertia_load"]),
        shafts=(
            replace(
                shaft, stiffness=shaft.stiffness * of["stiffness"], backlash=shaft.backlash * of["backlash"]
            ),
        ),
        frictions=tuple(_scaled_friction(friction, of["coulomb"]) for friction in drivetrain.frictions),
    )


def _scaled_friction(friction: Friction, share: float) -> Friction:
    return replace(friction, coulomb=(share * friction.coulomb_plus, share * friction.coulomb_minus))


def in_torque(loop: LureLoop, drivetrain: Drivetrain) -> LureLoop:
    """The loop with the twist, and argument and value of every plant curve, in Nm (friction's argument stays a speed).

    stiffness · twist takes the twist's place. Then the stiffness is in the rate of this state alone, and neither
    backlash nor friction is in any matrix: they are in the curves.
    """
    k = Fraction(drivetrain.stiffness)
    state = identity(len(loop.states))
    state[0, 0] = k
    back = identity(len(loop.states))
    back[0, 0] = 1 / k
    heights = [_height(name, drivetrain) for name in loop.names[: len(loop.plant_curves)]]
    widths = [k if name == "gap" else Fraction(1) for name in loop.names[: len(heights)]]
    by_value = np.diag(np.array([1 / height for height in heights], dtype=object))
    by_value = rational(by_value) if heights else loop.E[:0, :0]
    argument = rational(np.diag(np.array(widths, dtype=object))) if heights else by_value
    curves = tuple(
        StaticCurve(
            tuple((width * z, height * w) for z, w in curve.points), height * curve.left / width,
            height * curve.right / width,
        )
        for curve, width, height in zip(loop.plant_curves, widths, heights, strict=True)
    )  # fmt: skip
    return replace(
        loop, A=state @ loop.A @ back, E=state @ loop.E @ by_value, L=state @ loop.L, R=state @ loop.R,
        Z=argument @ loop.Z @ back, S=state @ loop.S @ back, S_w=state @ loop.S_w @ by_value, S_v=state @ loop.S_v,
        N=loop.N @ back, N_w=loop.N_w @ by_value, plant_curves=curves,
    )  # fmt: skip


def _height(name: str, drivetrain: Drivetrain) -> Fraction:
    """Torque (Nm) of a plant curve of height 1; 1 for a law's curve in continuous time."""
    friction = {"friction of the motor": 0, "friction of the load": 1}
    if name == "gap":
        return Fraction(drivetrain.stiffness) * Fraction(drivetrain.backlash)
    if name in friction:
        of = drivetrain.frictions[friction[name]]
        return Fraction(of.coulomb_plus) + Fraction(of.coulomb_minus)
    return Fraction(1)


def flow_corners(cell: Cell) -> list[dict[str, float]]:
    """Corners of what enters the flow: stiffness and inertias."""
    return corners(cell, ("stiffness", "inertia_load", "inertia_motor"))


def rest_corners(cell: Cell) -> list[dict[str, float]]:
    """Where the sectors are widest: the largest stiffness and backlash, the smallest and largest friction."""
    largest = {name: cell[name][1] for name in ("stiffness", "backlash") if name in cell}
    return [{**corner, **largest} for corner in corners(cell, ("coulomb",))]


def corners(cell: Cell, names: Sequence[str]) -> list[dict[str, float]]:
    """Every combination of smallest and largest share."""
    ends = [[(name, share) for share in sorted(set(cell[name]))] for name in names if name in cell]
    return [dict(combination) for combination in product(*ends)]


@dataclass(frozen=True, eq=False)
class CellProof:
    """The inequalities of ``SampledProof`` at the corners of a cell, with one P and one set of integrals.

    What does not hang on the parameters stands once. Multipliers of the flow may differ from corner to corner: between
    them they are interpolated, as the flow is. In continuous time P stands still and nothing happens at samples.

    Parameters
    ----------
    flows : tuple of SampledProof
        One for each of ``flow_corners``; they differ in A and E alone.
    continuous : bool
    """

    flows: tuple[SampledProof, ...]
    continuous: bool

    @cached_property
    def layout(self) -> Layout:
        own = self.flows[0].layout()
        multipliers = dict(own.multipliers)
        for name in ("flow_sectors", "flow_copies"):
            count = multipliers.pop(name)
            multipliers |= {f"{name}_{i}": count for i in range(len(self.flows))}
        if not self.continuous:
            return Layout(own.symmetric, multipliers)
        kept = {name: n for name, n in multipliers.items() if name.startswith(("eta", "flow"))}
        return Layout({"P0": own.symmetric["P0"]}, {n: c // 2 if "flow" in n else c for n, c in kept.items()})

    def conditions(self, unknowns: Unknowns) -> list[Matrix]:
        """Matrices that must be positive definite: those of ``SampledProof``, the flow's at each corner."""
        first, substeps = self.flows[0], range(self.flows[0].substeps)
        ends = (0,) if self.continuous else (0, 1)
        given = [self.at_corner(unknowns, i) for i in range(len(self.flows))]
        flow = [
            proof.falls(own, k, end)
            for proof, own in zip(self.flows, given, strict=True)
            for k in substeps
            for end in ends
        ]
        if self.continuous:
            return [first.positive(given[0], 0), *flow]
        knots = range(first.substeps + 1)
        region = [] if first.limit is None else [first.contains(unknowns), first.starts_inside(unknowns)]
        return [*(first.positive(unknowns, k) for k in knots), *flow, first.does_not_rise(unknowns), *region]

    def at_corner(self, unknowns: Unknowns, i: int) -> dict[str, Matrix]:
        """The unknowns as ``SampledProof`` has them, with the multipliers of one corner's flow."""
        own = dict(unknowns)
        for name in ("flow_sectors", "flow_copies"):
            own[name] = unknowns[f"{name}_{i}"]
            if self.continuous:  # both ends of its sample are alike
                own[name] = np.concatenate([own[name], own[name]])
        if self.continuous:
            own["P1"] = own["P0"]
            nothing = ("theta_plus", "theta_minus", "rest_sectors", "rest_copies", "jump_sectors", "jump_copies")
            own |= dict.fromkeys(nothing, np.zeros(0))
        return own

    def sizes(self, of_one: Sequence[Matrix]) -> list[Matrix]:
        """Typical sizes of the conditions, from those of one ``SampledProof``."""
        knots, ends = self.flows[0].substeps + 1, 2 * self.flows[0].substeps
        flow = list(of_one[knots : knots + ends]) * len(self.flows)
        if self.continuous:
            return [of_one[0], *flow[: len(self.flows)]]
        return [*of_one[:knots], *flow, *of_one[knots + ends :]]


def with_flows_of(proof: SampledProof, loops: Sequence[LureLoop]) -> tuple[SampledProof, ...]:
    """The proof, in floats, with the flow of each loop."""
    first = proof.floats()
    step = float(loops[0].dt) / proof.substeps
    return tuple(
        replace(first, A=loop.A.astype(float) * step, E=loop.E.astype(float) * step) for loop in loops
    )

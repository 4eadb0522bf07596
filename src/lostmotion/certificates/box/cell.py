"""A cell of a box of drivetrains: one V, or one family of V, that proves the loop with every drivetrain in the cell.

In units of torque the parameters enter the flow alone, and each only once: docs/proofs.md, equations 24 to 26.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations, product

import numpy as np

from ...drivetrain import Drivetrain, Friction
from ..lure import LureLoop
from ..rational import Matrix
from ..sampled_proof import SampledProof
from ..semidefinite import Layout, Unknowns
from ..static_curves import StaticCurve

#: Parameters that a box may vary; each is a share of its nominal value.
PARAMETERS = ("inertia_load", "stiffness", "coulomb", "backlash", "inertia_motor")

#: Those that enter the flow.
IN_THE_FLOW = ("stiffness", "inertia_load", "inertia_motor")

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
    names = loop.names[: len(loop.plant_curves)]
    heights = [_height(name, drivetrain) for name in names]
    widths = [k if name == "gap" else Fraction(1) for name in names]
    curves = tuple(
        StaticCurve(
            tuple((width * z, height * w) for z, w in curve.points), height * curve.left / width,
            height * curve.right / width,
        )
        for curve, width, height in zip(loop.plant_curves, widths, heights, strict=True)
    )  # fmt: skip
    made = {
        key: getattr(loop, key).copy() for key in ("A", "E", "L", "R", "Z", "S", "S_w", "S_v", "N", "N_w")
    }
    for key in ("A", "E", "L", "R", "S", "S_w", "S_v"):
        made[key][0] *= k
    for key in ("A", "Z", "S", "N"):
        made[key][:, 0] /= k
    for key in ("E", "S_w", "N_w"):
        made[key] /= np.array(heights, dtype=object) if heights else 1
    made["Z"] = (np.array(widths, dtype=object)[:, np.newaxis] * made["Z"]) if widths else made["Z"]
    return replace(loop, **made, plant_curves=curves)


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
    return corners(cell, IN_THE_FLOW)


def rest_corners(cell: Cell) -> list[dict[str, float]]:
    """Where the sectors are widest: the largest stiffness and backlash, the smallest and largest friction."""
    largest = {name: cell[name][1] for name in ("stiffness", "backlash") if name in cell}
    return [{**corner, **largest} for corner in corners(cell, ("coulomb",))]


def corners(cell: Cell, names: Sequence[str]) -> list[dict[str, float]]:
    """Every combination of smallest and largest share."""
    ends = [[(name, share) for share in sorted(set(cell[name]))] for name in names if name in cell]
    return [dict(combination) for combination in product(*ends)]


#: The state (layout) whose rate, and no other, is proportional to the parameter or to one over it, in units of torque.
RATE_OF = {"stiffness": 0, "inertia_motor": 1, "inertia_load": 2}


@dataclass(frozen=True, eq=False)
class CellProof:
    """The inequalities of ``SampledProof`` at each corner of a cell, coupled so that they hold in all of it.

    Every corner has numbers of its own, between corners they are interpolated. So that nothing is quadratic in a
    parameter, the plant's integrals have the same weights everywhere, and the row of P that belongs to a parameter's
    rate does not change with that parameter (docs/proofs.md, equation 25). In continuous time P stands still and
    nothing happens at samples.

    Parameters
    ----------
    proofs : tuple of SampledProof
        One for each of ``flow_corners(cell)``; they differ in A and E alone.
    cell : Cell
    continuous : bool
    """

    proofs: tuple[SampledProof, ...]
    cell: Cell
    continuous: bool

    @cached_property
    def varied(self) -> tuple[str, ...]:
        """Parameters that differ from corner to corner."""
        return tuple(
            name for name in IN_THE_FLOW if name in self.cell and self.cell[name][0] < self.cell[name][1]
        )

    @cached_property
    def layout(self) -> Layout:
        """P of the first corner, what each set of parameters adds to it, common integrals, own multipliers."""
        own = self.proofs[0].layout()
        knots = ["P0"] if self.continuous else list(own.symmetric)
        symmetric = {
            _part(knot, subset): own.symmetric[knot] - len(subset)
            for knot in knots
            for subset in _subsets(self.varied)
        }
        common = {name: own.multipliers[name] for name in ("eta_plus", "eta_minus")}
        each = {name: count for name, count in own.multipliers.items() if name not in common}
        if self.continuous:  # both ends of its sample are alike
            each = {name: count // 2 for name, count in each.items() if name.startswith("flow")}
        corners = range(len(self.proofs))
        return Layout(symmetric, common | {f"{name} {i}": n for i in corners for name, n in each.items()})

    def conditions(self, unknowns: Unknowns) -> list[Matrix]:
        """Matrices that must be positive definite."""
        found = []
        for i, proof in enumerate(self.proofs):
            own = self.at_corner(unknowns, i)
            if self.continuous:
                found += [proof.positive(own, 0), proof.falls(own, 0, 0)]
            else:
                found += proof.conditions(own)
        return found

    def sizes(self, of_one: Sequence[Matrix]) -> list[Matrix]:
        """Typical sizes of the conditions, from those of one ``SampledProof``."""
        return list(of_one[::2][:2] if self.continuous else of_one) * len(self.proofs)

    def at_corner(self, unknowns: Unknowns, i: int) -> dict[str, Matrix]:
        """The unknowns of one corner, as ``SampledProof`` has them."""
        own: dict[str, Matrix] = {name: unknowns[name] for name in ("eta_plus", "eta_minus")}
        own |= {name.rsplit(" ", 1)[0]: v for name, v in unknowns.items() if name.endswith(f" {i}")}
        raised = self._raised[i]
        for knot in ("P0",) if self.continuous else self.proofs[0].layout().symmetric:
            total = unknowns[knot].copy()
            for subset in _subsets(raised)[1:]:
                kept = [s for s in range(len(total)) if s not in {RATE_OF[name] for name in subset}]
                total[np.ix_(kept, kept)] += unknowns[_part(knot, subset)]
            own[knot] = total
        if self.continuous:
            nothing = (
                "theta_plus",
                "theta_minus",
                "rest_sectors",
                "rest_copies",
                "jump_sectors",
                "jump_copies",
            )
            own |= dict.fromkeys(nothing, np.zeros(0))
            own |= {name: np.tile(own[name], 2) for name in ("flow_sectors", "flow_copies")}
            own["P1"] = own["P0"]
        return own

    @cached_property
    def _raised(self) -> list[tuple[str, ...]]:
        """For each corner: the parameters that have their largest share there."""
        return [
            tuple(name for name in self.varied if corner[name] == self.cell[name][1])
            for corner in flow_corners(self.cell)
        ]


def _subsets(names: Sequence[str]) -> list[tuple[str, ...]]:
    """All subsets, the empty one first."""
    return [subset for size in range(len(names) + 1) for subset in combinations(names, size)]


def _part(knot: str, subset: Sequence[str]) -> str:
    """Name of what raising the parameters of a set adds to P."""
    return " + ".join((knot, *subset))


def with_flows_of(proof: SampledProof, loops: Sequence[LureLoop]) -> tuple[SampledProof, ...]:
    """The proof, in floats, with the flow of each loop."""
    first = proof.floats()
    step = float(loops[0].dt) / proof.substeps
    return tuple(
        replace(first, A=loop.A.astype(float) * step, E=loop.E.astype(float) * step) for loop in loops
    )

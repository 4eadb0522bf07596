"""The largest share of the gap's slope that a criterion proves: the usual figure of merit of the literature.

The gap's curve is taken to lie between 0 and share · stiffness: 1 is the whole gap. Without friction, around the middle
of the gap, in continuous time. The proofs of this package do without it (docs/proofs.md, equation 7): the loop
that turns rests in contact, and there the share is below 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ..box.cell import CellProof
from ..certificate import short
from ..continuous.continuous_law import ContinuousLaw
from ..continuous.continuous_loop import continuous_loop
from ..equilibrium import Equilibrium
from ..lure import LureLoop
from ..rational import Matrix, is_positive_definite, rational, zeros
from ..sampled_proof import SampledProof, sampled_proof
from ..scaling import condition_sizes, state_sizes
from ..sectors import Copies, Sector
from ..semidefinite import Inequalities, Unknowns
from .zames_falb import is_stable_with_flow, weights

#: The criteria, each stronger than the one before: circle (quadratic V), Popov (with integrals), with the cross
#: condition of two arguments of one curve, and with filtered signals.
CRITERIA = ("circle", "popov", "cross", "zames_falb")

#: Accuracy of the search (option).
TOLERANCE = 1e-4


@dataclass(frozen=True)
class Question:
    """Whether a criterion proves the loop for a share."""

    loop: LureLoop
    criterion: str

    def is_proved(self, share: Fraction) -> bool:
        """Found in floats, checked in exact fractions."""
        exact = self.proof(share)
        problem = CellProof((exact.floats(),), {}, continuous=True)
        sizes = state_sizes(problem.proofs[0])
        if sizes is None:
            return False
        if self.criterion == "zames_falb":
            return self.is_stable_with_flow and weights(self.loop, share, sizes) is not None
        scales = problem.sizes(condition_sizes(problem.proofs[0], sizes))
        found = Inequalities(
            lambda u: problem.conditions(self.used(u)), problem.layout, scales
        ).largest_margin()
        if found is None:
            return False
        unknowns = self.used({name: rational(short(value)) for name, value in found[0].items()})
        return all(map(is_positive_definite, CellProof((exact,), {}, continuous=True).conditions(unknowns)))

    @cached_property
    def is_stable_with_flow(self) -> bool:
        """Whether the loop with the gap closed, which no share changes, is stable."""
        return is_stable_with_flow(self.loop.A)

    def used(self, unknowns: Unknowns) -> Mapping[str, Matrix]:
        """The circle criterion has no integrals."""
        if self.criterion != "circle":
            return unknowns
        return {name: 0 * value if name.startswith("eta") else value for name, value in unknowns.items()}

    def proof(self, share: Fraction) -> SampledProof:
        """The inequalities with the sector [0, share · slope] of each copy of the gap."""
        curves = self.loop.plant_curves
        slopes = [curve.steepest or Fraction(0) for curve in curves]
        copies = tuple(
            Copies(i, j, share * slopes[j], Fraction(0), Fraction(0))
            for j in range(len(curves))
            for i in range(j)
            if self.criterion == "cross"
        )
        sectors = [Sector(Fraction(0), share * slope) for slope in slopes]
        flat = (0,) * len(curves)  # the linear loop, of which sizes are taken, is that with the gap closed
        rest = Equilibrium(Fraction(0), Fraction(0), zeros(0, 1), Fraction(0), (), flat)
        return sampled_proof(self.loop, rest, sectors, copies)


@checks_arguments
def largest_share(drivetrain: Drivetrain, law: ContinuousLaw, criterion: str = "cross") -> float:
    """The largest share of the gap's slope for which a criterion proves global asymptotic stability, exact to 1e-4.

    Parameters
    ----------
    drivetrain : Drivetrain
        With a gap and without Coulomb friction.
    law : ContinuousLaw
        Its curves, if any, are copies of the gap.
    criterion : {"circle", "popov", "cross", "zames_falb"}

    Returns
    -------
    float
        1.0 where the whole gap is proved; 0.0 where nothing is.

    Raises
    ------
    InvalidInput
        For an unknown criterion, a loop without a gap, and curves other than that of the gap.

    Notes
    -----
    Popov 1961, Avtomatika i Telemekhanika 22, 961–979; circle: Zames 1966, IEEE Trans. Automatic Control 11, 465–476;
    Zames & Falb 1968, SIAM J. Control 6, 89–108; of several curves that are one: D'Amato, Rotea, Megretski & Jönsson
    2001, Automatica 37, 739–747.
    """
    if criterion not in CRITERIA:
        raise InvalidInput("criterion", repr(criterion), f"one of {', '.join(CRITERIA)}", "Choose one.")
    loop = continuous_loop(drivetrain, law)
    if not loop.plant_curves or any(curve != loop.plant_curves[0] for curve in loop.plant_curves):
        raise InvalidInput(
            "drivetrain",
            "no gap, or curves beside it",
            "a gap alone",
            "Leave friction out of drivetrain and law.",
        )
    return share_of_loop(loop, criterion)


def share_of_loop(loop: LureLoop, criterion: str) -> float:
    """The same for a loop in continuous time, all of whose curves are one."""
    question = Question(loop, criterion)
    if question.is_proved(Fraction(1)):
        return 1.0
    low, high = 0.0, 1.0
    while high - low > TOLERANCE:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if question.is_proved(Fraction(middle)) else (low, middle)
    return low

"""Which contact law predicts a recording better, or that they cannot be distinguished."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import Problem
from ...recording import Recording
from ..statistics.block_covariance import block_squares
from ..statistics.permuted_signs import chance_of
from . import problems as problem
from .identify import CONTACTS, identify
from .result import Identification

Array = NDArray[np.float64]

#: The better law must lower the innovations' sum of squares by this fraction (calibrated on two masses of Table I under
#: both laws, seeds 1 and 2, ``benchmarks/calibrations.py``: 4 of 4 are right with half and double of it; below, what
#: else the model leaves out may decide), and the recording's blocks must agree with this chance (option).
LEAST_GAIN, CERTAIN = 0.01, 0.975


@dataclass(frozen=True, eq=False, repr=False)
class ContactComparison:
    """Both laws fitted to the same rows.

    Parameters
    ----------
    better : str or None
        The law that predicts better; None where they cannot be distinguished.
    gain : float
        By how much it lowers the sum of squares of the innovations, as a fraction.
    certainty : float
        Standard deviations of a normal distribution beyond which lies as little as the chance that blocks which favour
        neither law agree so well.
    found : mapping of law → Identification
    problems : tuple of Problem
        A warning where the laws cannot be distinguished.
    """

    better: str | None
    gain: float
    certainty: float
    found: Mapping[str, Identification]
    problems: tuple[Problem, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "found", MappingProxyType(dict(self.found)))

    def __repr__(self) -> str:
        laws = " and ".join(self.found)
        verdict = (
            f"{laws} cannot be distinguished" if self.better is None else f"{self.better} predicts better"
        )
        how = f"by {100.0 * self.gain:.2g} %, {self.certainty:.1f} standard deviations"
        return f"{type(self).__name__}: {verdict} ({how})"

    def summary(self) -> str:
        """Which law predicts better, then what was identified under each."""
        return "\n".join([repr(self), *(f"{law}, {found.summary()}" for law, found in self.found.items())])


@checks_arguments
def compare_contacts(
    recording: Recording | Sequence[Recording],
    *,
    start: Drivetrain,
    fixed: Collection[str] = (),
    speed_from_counts: bool | None = None,
) -> ContactComparison:
    """Identify under the laws "viscoelastic" and "dead_zone", and compare how well they predict the motor speed.

    With no damping, or hardly any motion inside the gap, the two are the same law. Both are fitted by the observer of
    constant gain alone, as the second estimator has laws of its own: ``identify`` judges the values. Parameters as
    there.

    Returns
    -------
    ContactComparison
    """
    from scipy.stats import norm

    found = {
        law: identify(
            recording,
            start=start,
            fixed=fixed,
            contact=law,
            joint_piece=False,
            second_estimator=False,
            speed_from_counts=speed_from_counts,
        )
        for law in CONTACTS
    }
    order = sorted(CONTACTS, key=lambda law: found[law].prediction.rms)
    best, other = (found[law].prediction.residual for law in order)
    of_best, of_other = block_squares(best), block_squares(other)
    gain = 1.0 - float(np.sum(of_best) / max(np.sum(of_other), 1e-300))
    # A few blocks that differ much do not hide that all agree, as their deviation in Student's test would.
    certainty = max(float(norm.isf(chance_of(of_other - of_best))), 0.0)
    told = gain > LEAST_GAIN and certainty > float(norm.ppf(CERTAIN))
    problems = () if told else (problem.laws_alike(gain, certainty, LEAST_GAIN),)
    return ContactComparison(order[0] if told else None, gain, certainty, found, problems)

"""How far twist, speeds and torque can go: bounds for every set-point within a limit, standstill among them.

Level sets of functions V that no motion leaves, one for each bound. What is known of a motion from the sets found
before makes the next ones smaller. Found in floats, proved in fractions: docs/proofs.md, equations 28 to 32.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...argument_checks import checks_arguments, not_negative
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem
from ..continuous.continuous_law import ContinuousLaw
from .level_set_search import smallest_peaks
from .peak_outputs import PeakLoop, continuous_peak_loop, sampled_peak_loop


@dataclass(frozen=True)
class PeakBounds:
    """Bounds that no motion from rest in the middle of the gap exceeds, for |set-point| ≤ ``reference``, and that every
    other motion falls below in the end.

    twist in rad, speeds in rad/s, torque_motor in Nm, inf where no bound was found; ``limit_acts``: False where the
    torque limit cannot act, None where that is not shown.
    """

    reference: float
    twist: float
    speed_motor: float
    speed_load: float
    torque_motor: float
    limit_acts: bool | None


@checks_arguments
def peak_bounds(
    drivetrain: Drivetrain,
    law: ContinuousLaw | DiscreteSystem,
    reference: float = 0.0,
    *,
    delay: int = 0,
    substeps: int = 1,
) -> PeakBounds:
    """Bounds of all motions with set-points up to ``reference`` (rad/s), with gap and friction.

    Parameters
    ----------
    drivetrain : Drivetrain
        With a torque lag only where the law is sampled. Its torque limit, and the law's own, are left out: the bounds
        hold where the limit does not act, which they show if the torque's is below it.
    law : ContinuousLaw or DiscreteSystem
        The sampled law acts on the drivetrain in continuous time; the bounds hold between samples, too.
    reference : float, rad/s
        Largest set-point in both directions; it may change at any time in any way. With 0 what is bounded is how far
        the loop may hunt.
    delay : int
        Computing delay of a sampled law, in samples.
    substeps : int
        Intervals of V over a sample.

    Raises
    ------
    InvalidInput
        For a lag with a continuous law, a loop without a Lur'e form, curves other than saturations and jumps, and a
        loop that is not stable with gap closed and friction constant.

    Notes
    -----
    Invariant level sets: Abedor, Nagpal & Poolla 1996, Int. J. Robust and Nonlinear Control 6, 899-927; V quadratic in
    the states and the saturations' values: Dai, Hu, Teel & Zaccarian 2009, Systems & Control Letters 58, 365-371.
    """
    reference = not_negative("peak_bounds.reference", reference)
    if delay < 0 or substeps < 1:
        raise InvalidInput("peak_bounds", f"delay {delay}, substeps {substeps}", "≥ 0 and ≥ 1", "Check them.")
    loop = _loop(drivetrain, law, delay)
    peaks = smallest_peaks(loop, Fraction(reference), substeps)
    if peaks is None:
        raise InvalidInput("law", "a loop that is not stable in contact", "a stable one", "Check the gains.")
    torque = peaks["torque_motor"]
    return PeakBounds(
        reference, peaks["twist"], peaks["speed_motor"], peaks["speed_load"], torque,
        limit_acts=False if torque < loop.limit else None,
    )  # fmt: skip


def _loop(drivetrain: Drivetrain, law: ContinuousLaw | DiscreteSystem, delay: int) -> PeakLoop:
    if isinstance(law, DiscreteSystem):
        return sampled_peak_loop(drivetrain, law, delay)
    if drivetrain.lag:
        raise InvalidInput(
            "drivetrain", f"lag {drivetrain.lag:g} s", "no torque lag with a continuous law", "Leave it out."
        )
    if delay:
        raise InvalidInput("peak_bounds.delay", f"{delay}", "0 for a continuous law", "Leave it out.")
    limit = drivetrain.actuator.torque_limit
    return continuous_peak_loop(drivetrain.with_parameters(torque_limit=np.inf), law, limit)

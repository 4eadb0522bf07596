"""How far twist, speeds and torque can go: bounds for every set-point within a limit, standstill among them.

Gap and friction are inputs that are bounded, whatever they do. A share of each that is proportional to its argument is
left in the linear loop: what remains is smaller, because the argument stays within the bound that was found before.
docs/proofs.md, equations 28 and 29.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments, not_negative
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ..certificate import short
from ..continuous.continuous_law import ContinuousLaw
from ..continuous.continuous_loop import continuous_loop
from ..lure import LureLoop
from ..plant import plant_of
from ..rational import Matrix, rational, zeros
from ..static_curves import StaticCurve
from .peak_integrals import peak_integrals

Array = NDArray[np.float64]

#: Shares of the best slope for the gap, and of the largest that costs nothing for friction, that are tried (option).
GAP_SHARES, FRICTION_SHARES = (0.5, 1.0), (1.0,)

#: Rounds of the search, and the gain below which it ends (option).
ROUNDS, LEAST_GAIN = 2, 0.02


@dataclass(frozen=True)
class PeakBounds:
    """Bounds that no motion from rest in the middle of the gap exceeds, for |set-point| ≤ ``reference``.

    twist in rad, speeds in rad/s, torque_motor in Nm; ``limit_acts``: False where the torque limit cannot act, None
    where that is not shown.
    """

    reference: float
    twist: float
    speed_motor: float
    speed_load: float
    torque_motor: float
    limit_acts: bool | None


@checks_arguments
def peak_bounds(drivetrain: Drivetrain, law: ContinuousLaw, reference: float = 0.0) -> PeakBounds:
    """Bounds of all motions from rest with set-points up to ``reference`` (rad/s), with gap and friction.

    Parameters
    ----------
    drivetrain : Drivetrain
        Without torque lag. Its torque limit is left out: the bounds hold where the limit does not act, which they show
        if the torque's is below it.
    law : ContinuousLaw
    reference : float, rad/s
        Largest set-point in both directions; it may change at any time in any way. With 0 what is bounded is how far
        the loop may hunt.

    Raises
    ------
    InvalidInput
        For a lag, a loop without a Lur'e form, and one that is not stable with gap closed and friction constant.

    Notes
    -----
    The peak gain is the integral of the impulse response's size: Dahleh & Pearson 1987, IEEE Trans. Automatic Control
    32, 314-321.
    """
    reference = not_negative("peak_bounds.reference", reference)
    if drivetrain.lag:
        raise InvalidInput("drivetrain", f"lag {drivetrain.lag:g} s", "no torque lag", "Leave it out.")
    limit = drivetrain.actuator.torque_limit
    unlimited = drivetrain.with_parameters(torque_limit=np.inf)
    loop = continuous_loop(unlimited, law)
    if any(curve.left or curve.right for curve in loop.plant_curves):
        raise InvalidInput(
            "law", "a curve without bounds", "bounded curves beside a linear law", "Leave it out."
        )
    search = _Search(loop, _torque(loop, unlimited), reference)
    peaks = search.smallest()
    if peaks is None:
        raise InvalidInput("law", "a loop that is not stable in contact", "a stable one", "Check the gains.")
    torque = float(peaks[3])
    twist, motor, load = (float(peak) for peak in peaks[:3])
    return PeakBounds(reference, twist, motor, load, torque, limit_acts=False if torque < limit else None)


def _torque(loop: LureLoop, drivetrain: Drivetrain) -> tuple[Matrix, Matrix, Matrix]:
    """The motor torque over states (n,), curves (q,) and set-point (1,): what the law adds to the motor's momentum."""
    plant, inertia = plant_of(drivetrain), Fraction(drivetrain.inertia_motor)
    n, p = len(plant.states), len(plant.curves)
    state, curve = inertia * loop.A[1], inertia * loop.E[1]
    state[:n] -= inertia * plant.A[1]
    curve[:p] -= inertia * plant.E[1]
    return state, curve, inertia * loop.R[1]


@dataclass(frozen=True, eq=False)
class _Search:
    """Which share of each curve is left in the linear loop."""

    loop: LureLoop
    torque: tuple[Matrix, Matrix, Matrix]
    reference: float

    def smallest(self) -> Array | None:
        """Peaks (4 + q,) of outputs and of curve arguments; None if the loop is not stable in contact."""
        best = self.peaks(np.zeros(len(self.loop.plant_curves)), None)
        for _ in range(ROUNDS if best is not None else 0):
            assert best is not None
            tried = [self.peaks(slopes, best[4:]) for slopes in self._slopes(best[4:])]
            # Each holds: so does the smallest of each peak.
            new = np.min([best, *(peaks for peaks in tried if peaks is not None)], axis=0)
            done = bool(np.all(new > (1.0 - LEAST_GAIN) * best))
            best = new
            if done:
                break
        return best

    def _slopes(self, widths: Array) -> Iterator[Array]:
        """Slopes for arguments within widths: of a curve with a slope, and of a jump."""
        curves = self.loop.plant_curves
        for gap, friction in product(GAP_SHARES, FRICTION_SHARES):
            made = [
                friction / width if curve.steepest is None else gap * _even(curve, width)
                for curve, width in zip(curves, widths, strict=True)
            ]
            yield short(np.array(made))

    def peaks(self, slopes: Array, widths: Array | None) -> Array | None:
        """The bounds with these slopes left in the loop, whose arguments are known to stay within ``widths``; None if
        that loop is not stable."""
        loop, own = self.loop, rational(slopes)
        curve_of_state = own[:, np.newaxis] * loop.Z
        state, curve, given = self.torque
        rows = np.vstack([_first_states(loop), state + curve @ curve_of_state, loop.Z])
        columns = np.hstack([loop.E, loop.R])
        integrals = peak_integrals(loop.A + loop.E @ curve_of_state, columns, rows)
        if integrals is None:
            return None
        known = [None] * slopes.size if widths is None else widths.tolist()
        left = [_left(*each) for each in zip(loop.plant_curves, slopes.tolist(), known, strict=True)]
        sizes = np.append(left, self.reference)
        peaks = integrals @ sizes
        # The torque reads set-point and curves directly, too.
        peaks[3] += np.abs(np.append(curve, given).astype(float)) @ sizes
        return np.asarray(peaks * (1.0 + 1e-9))


def _first_states(loop: LureLoop) -> Matrix:
    """Rows of twist and speeds, which are the first states."""
    rows = zeros(3, len(loop.states))
    for i in range(3):
        rows[i, i] = Fraction(1)
    return rows


def _even(curve: StaticCurve, width: float) -> float:
    """The slope that leaves as much of a saturation at its corner as at the end of the width."""
    corner, height = float(curve.points[-1][0]), float(curve.points[-1][1])
    return min(2.0 * height / (corner + width), height / corner)


def _left(curve: StaticCurve, slope: float, width: float | None) -> float:
    """Largest |w − slope·z| over |z| ≤ width (any z: width None, slope 0)."""
    found = [abs(float(w) - slope * float(z)) for z, w in curve.points]
    if width is not None:
        ends = [(width, curve.points[-1][1]), (-width, curve.points[0][1])]
        found += [abs(float(w) - slope * z) for z, w in ends]
    return max(found) * (1.0 + 1e-12)

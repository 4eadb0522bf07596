"""A candidate without a gap, and up to which size one would not show: "no backlash above … rad"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ....statistics.block_covariance import student_factor
from ...gap.absent_gap import FIRST, shown
from ..likelihood import Box, Candidate, cost_of, inverse_hessian, minimise, polish
from ..likelihood_ratio import alike
from ..parameter_vector import INDEX

PLACE, OFFSET = INDEX["backlash"], INDEX["torque_offset"]
#: A gap shows where its drive costs so much more without it, the rates of the unknown torques as they are (numerics: a
#: drive that has none costs up to 0.2 more then); likewise for another name of the same chain.
SHOWN = 0.5
#: Gauss–Newton steps without the gap, or with one of a given size (numerics: what a small gap changes).
STEPS = 4
#: How much lower the rates of unknown torques start as well (numerics: two of their steps).
LOWER = 10.0
#: Steps from one size of the gap to the next until the bound lies between two; how near these are at the end; and how
#: far below the first a gap is none (numerics).
STRIDE, NARROW, FAR = 4.0, 1.3, 1e4


def gap_of(candidate: Candidate) -> float:
    """Backlash, rad."""
    return float(np.exp(candidate.theta[PLACE]))


def bare(candidate: Candidate) -> Candidate:
    """The candidate with a backlash of zero; its cost is still that with the gap.

    Without a gap a constant torque on the motor is one on the load, which the filter follows anyway: it keeps its value
    and is no longer fitted.
    """
    theta = candidate.theta.copy()
    theta[PLACE] = -np.inf
    return replace(candidate, theta=theta, free=[i for i in candidate.free if i not in (PLACE, OFFSET)])


def without_gap(best: Candidate, box: Box) -> Candidate | None:
    """The candidate fitted without its gap; None if it predicts worse."""
    found = bare(best)
    if best.flt.run(found.theta).cost > best.cost + SHOWN:
        return None
    # With its rates: each contact of the smallest gap makes the filter less sure of the motion. No descent brings high
    # rates down, nor a constant torque that held the gap on one side: one begins with less of each as well.
    begun = [
        found,
        _less_unknown(found),
        replace(found, theta=found.flt.changed(found.theta, torque_offset=0.0)),
    ]
    found = min((polish(one, one.flt, box, STEPS) for one in begun), key=cost_of)
    return found if alike(found, best) else None


def _less_unknown(candidate: Candidate) -> Candidate:
    """The candidate with lower rates of the unknown torques on motor and load."""
    theta = candidate.theta.copy()
    theta[[INDEX["motor_rate"], INDEX["load_rate"]]] -= np.log(LOWER)
    return replace(candidate, theta=theta)


def gap_bound(gapless: Candidate, wider: float, box: Box, others: Sequence[Candidate] = ()) -> float | None:
    """Upper end of the 95 % interval (rad) of the gap of a candidate without one, from its profile likelihood.

    With a gap of each size the other parameters are fitted anew; beyond the bound the recording is predicted worse than
    the noise makes it. The gap of any of the others that does not predict it worse is below the bound as well.
    ``wider``: by how much intervals are wider than those of noise alone. None where a gap as large as the wind-up at
    the largest torque would not show either, or no gap changes the innovations.
    """
    flt, stiffness = gapless.flt, float(np.exp(gapless.theta[INDEX["stiffness"]]))
    first, widest = FIRST * flt.torque_deviation / stiffness, float(np.max(np.abs(flt.torque))) / stiffness
    colour = _colour(gapless, first)
    if colour is None:
        return None
    # A gap that is d standard errors away raises the mean cost by d²/(2·rows).
    rise = 0.5 * (student_factor(1) * wider * colour) ** 2 / flt.counting.size

    def cost(gap: float) -> float:
        theta = gapless.theta.copy()
        theta[PLACE] = np.log(gap)
        return minimise(flt, theta, gapless.free, box, STEPS)[1]

    # The smallest gap and none differ by what the filter makes of a contact: gaps are compared with gaps.
    costs, gap = {0.0: cost(first / FAR)}, first
    while gap < widest:
        costs[gap] = cost(gap)
        likely = min(costs.values()) + rise
        inside = max(each for each in costs if costs[each] <= likely)
        outside = min((each for each in costs if each > inside), default=np.inf)
        if outside < NARROW * inside or outside < first / FAR:
            return float(max([outside, *(gap_of(one) for one in others if one.cost <= likely)]))
        if np.isinf(outside):
            gap = STRIDE * inside
        else:
            gap = outside / STRIDE if inside == 0.0 else np.sqrt(inside * outside)
    return None


def _colour(gapless: Candidate, gap: float) -> float | None:
    """By how much slow innovations widen the interval of a gap over white ones.

    None where it has no effect, or the filter diverges with it.
    """
    run, theta = gapless.flt.run(gapless.theta, gapless.free), gapless.theta.copy()
    theta[PLACE] = np.log(gap)
    rows = gapless.flt.counting.size
    effect = (gapless.flt.run(theta).weighted - run.weighted)[:rows]
    if not np.any(effect) or not np.all(np.isfinite(effect)):
        return None
    jacobian, rest = np.vstack([run.jacobian[:, :rows], effect]), run.weighted[:rows]
    white = float(np.sqrt(inverse_hessian(jacobian)[-1, -1] * np.mean(rest**2)))
    return max(shown(jacobian, rest)[1] / white, 1.0)

"""A candidate without a gap, and up to which size one would not show: "no backlash above … rad"."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ....statistics.block_covariance import student_factor
from ...gap.absent_gap import FIRST, ROUNDS, shown
from ..filter import INDEX
from ..likelihood import Box, Candidate, inverse_hessian, minimise
from ..likelihood_ratio import alike

PLACE = INDEX["backlash"]
#: Gauss–Newton steps without the gap (numerics: what a small gap changes).
STEPS = 4


def bare(candidate: Candidate) -> Candidate:
    """The candidate with a backlash of zero; its cost is still that with the gap."""
    theta = candidate.theta.copy()
    theta[PLACE] = -np.inf
    return replace(candidate, theta=theta, free=[i for i in candidate.free if i != PLACE])


def without_gap(best: Candidate, box: Box) -> Candidate | None:
    """The candidate fitted without its gap; None if it predicts worse."""
    found = bare(best)
    theta, cost = minimise(found.flt, found.theta, found.free, box, STEPS)
    found = replace(found, theta=theta, cost=cost)
    return found if alike(found, best) else None


def gap_bound(gapless: Candidate, wider: float) -> float | None:
    """Upper end of the 95 % interval (rad) of the gap of a candidate without one.

    A small gap shifts the innovations in proportion to its size. What of this shift no other parameter can make up for
    is compared with the innovations. ``wider``: by how much intervals are wider than chance alone makes them. None
    where a gap as large as the wind-up would not show either.
    """
    flt, stiffness = gapless.flt, float(np.exp(gapless.theta[INDEX["stiffness"]]))
    run = flt.run(gapless.theta, gapless.free)
    gap = FIRST * flt.torque_deviation / stiffness
    for _ in range(ROUNDS):
        theta = gapless.theta.copy()
        theta[PLACE] = np.log(gap)
        effect = (flt.run(theta).weighted - run.weighted)[: flt.rows]
        if not np.any(effect):
            return None
        jacobian, rest = np.vstack([run.jacobian[:, : flt.rows], effect]), run.weighted[: flt.rows]
        step, coloured = shown(jacobian, rest)
        white = float(np.sqrt(inverse_hessian(jacobian)[-1, -1] * np.mean(rest**2)))
        gap *= step + student_factor(1) * wider * max(coloured, white)
        if not gap * stiffness < float(np.max(np.abs(flt.torque))):
            return None
    return gap

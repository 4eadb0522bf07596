"""Whether one candidate predicts significantly better than another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...statistics.block_covariance import BLOCKS
from ...statistics.permuted_signs import chance_of
from .likelihood import Candidate, cost_of

#: Rise of the log likelihood below which no candidate is better (numerics: ten more parameters raise it by five where
#: there is nothing to find).
LEAST_RISE = 10.0
#: Chance that blocks of two that predict alike rise as much (numerics: three standard deviations); of a rigid drive
#: (numerics: five blocks that all say so).
CHANCE, CHANCE_RIGID = 0.00135, 0.05
#: Candidates are alike if their costs differ by less than the first number and a part of the better one's, times the
#: part of the innovations that the model does not explain: what a model lacks may make up for so much, and one that
#: lacks nothing makes up for nothing. (Calibrated on development drives 300 to 400, and on 36 of 800 to 1083,
#: 2026-11-23: next to a wrong best another is that close, more than a tenth away, for 21 of 25 values; next to a right
#: one that explains the recording for none of 62.)
ALIKE, ALIKE_SHARE = 0.003, 0.35
#: The same part where innovations are below the sensor's noise, so that nothing says how well a model can predict
#: (calibrated on development drive 521: a wrong best was 0.03 of that better; 0.35 loses right values from coarse
#: counts).
BELOW_NOISE = 0.1
#: The part by which one has to be better to be clearly so (calibrated on development drives 0 to 5).
BETTER_SHARE = 0.2


def alike(one: Candidate, best: Candidate, share: float = ALIKE_SHARE) -> bool:
    """Whether a candidate's cost is about the best one's."""
    unexplained = -np.expm1(-2.0 * abs(best.cost)) * best.cost
    return bool(one.cost <= best.cost + ALIKE + max(share * unexplained, -BELOW_NOISE * best.cost))


def plausible_beside(one: Candidate, best: Candidate) -> bool:
    """Whether a candidate may be right although another predicts better: of the same structure if it is alike, of
    another if it comes near. Each structure lacks something else, and makes up for it otherwise."""
    near = one.cost <= best.cost + ALIKE + ALIKE_SHARE * best.cost
    return alike(one, best) or (near and one.structure != best.structure)


def simplest(found: Sequence[Candidate]) -> Candidate:
    """The one with the fewest parameters of those over the same rows that no other is better than; the lowest of these.

    A superfluous inertia, or a friction that does not rise, leaves the others' values much more room.
    """
    best = min(found, key=cost_of)
    highest = best.cost + LEAST_RISE / best.flt.counting.size
    return min((one for one in found if one.cost <= highest), key=lambda one: (len(one.free), one.cost))


def clearly_better(one: Candidate, other: Candidate, chance: float = CHANCE) -> bool:
    """Whether the first is likelier by more than model errors make up for, and in most blocks of the rows of both.

    Blocks of the recording instead of rows: where no model is right, its errors last longer than a sample. Source:
    Vuong (1989), Likelihood ratio tests for model selection and non-nested hypotheses, Econometrica 57, section 5.
    """
    if alike(other, one, BETTER_SHARE):
        return False
    if not np.isfinite(other.cost):
        return bool(np.isfinite(one.cost))
    rise = other.flt.run(other.theta).rows - one.flt.run(one.theta).rows
    blocks = np.array([np.mean(block) for block in np.array_split(rise, BLOCKS)])
    return bool(np.sum(rise) > LEAST_RISE and chance_of(blocks) < chance)

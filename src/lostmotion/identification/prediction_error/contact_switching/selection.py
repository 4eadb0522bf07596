"""Which of many candidates lie apart, or may be right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .estimate import distance
from .likelihood import Candidate, cost_of
from .likelihood_ratio import alike, plausible_beside

#: Candidates that differ by less than this in all logarithms are one (numerics: below an interval); by more than the
#: second they are elsewhere (numerics: a descent comes from about so far).
SAME, ELSEWHERE = 0.01, 0.3


def apart(found: Sequence[Candidate], far: float = SAME) -> list[Candidate]:
    """Candidates whose inertias, stiffness, damping or backlash are no better one's; the better ones come first."""
    kept: list[Candidate] = []
    for one in found:
        if all(np.max(distance(one, other)[:5]) > far for other in kept):
            kept.append(one)
    return kept


def plausible(found: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that may be right: those that predict about as well as the best, which comes first.

    A descent with more parts that predicts worse than one with some of them has failed: with nothing of the other parts
    it would be where that is.
    """
    found = sorted(found, key=cost_of)

    def arrived(one: Candidate) -> bool:
        return alike(one, next(other for other in found if one.contains(other)))

    return [one for one in found if plausible_beside(one, found[0]) and arrived(one)]

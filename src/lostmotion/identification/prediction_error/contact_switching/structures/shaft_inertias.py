"""A third inertia on the shaft, before the gap or behind it, and a fourth: where descents with one start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..filter import ContactFilter
from ..likelihood import (
    FITTED_LEVEL,
    LEVEL_FACTOR,
    Box,
    Candidate,
    cost_of,
    first_level,
    minimise,
    polish,
    side_by_side,
)
from ..parameter_vector import INDEX

Array = NDArray[np.float64]

#: Steps of a descent at each noise level (numerics).
STEPS = 4
#: Shares and compliances with which descents start: a joint beside a stiff shaft, a small one, and one beyond the
#: softest shaft (numerics).
PLACES = ((0.1, 0.3), (0.03, 0.6), (0.1, 0.9))
#: Shares and compliances that are looked at (numerics: a light or a heavy joint, on a stiff or a soft shaft).
SHARES, COMPLIANCES = (0.03, 0.1, 0.3, 0.6), (0.01, 0.03, 0.1, 0.3, 0.6, 0.9, 0.97)
#: Places of the parameters of a third inertia, and of a fourth.
THIRD, FOURTH = (
    [INDEX[f"{name}{which}"] for name in ("share", "compliance", "loss")] for which in ("", "_fourth")
)
#: With how many of the best on either side descents start as well (numerics).
FOLLOWED = 2
#: So many descents at least go on to the next noise level (numerics).
LAST = 20


@dataclass(frozen=True)
class Place:
    """Part of its side's inertia and of the shaft's compliance, loss factor over that at the gap, its side, and whether
    it is a fourth inertia: then both are parts of what the third leaves at the gap, see ``kernels``."""

    share: float
    compliance: float
    loss: float = 1.0
    behind: bool = False
    fourth: bool = False

    @property
    def free(self) -> list[int]:
        """Places of its parameters."""
        return FOURTH if self.fourth else THIRD

    @classmethod
    def of(cls, candidate: Candidate) -> Place | None:
        """Where a candidate has its third inertia, if it has one."""
        values = candidate.values
        share, compliance, loss = (values[name] for name in ("share", "compliance", "loss"))
        return cls(share, compliance, loss, candidate.flt.behind) if share > 0.0 else None


def places(
    candidate: Candidate, rows: ContactFilter, sides: Sequence[bool] = (False, True), fourth: bool = False
) -> list[Place]:
    """Where descents start, before the gap (False) or behind it: always the same, and those with which the candidate
    predicts some rows best.

    Share and compliance keep the first mode, so that a place near that of the drive lowers the cost as it is.
    """
    starts = []
    for behind in sides:
        pairs = [pair for pair in product(SHARES, COMPLIANCES) if pair not in PLACES]
        others = [Place(*pair, behind=behind, fourth=fourth) for pair in pairs]
        costs = side_by_side(lambda place: _cost_with(candidate, place, rows), others)
        starts += [Place(*pair, behind=behind, fourth=fourth) for pair in PLACES]
        starts += [others[i] for i in np.argsort(costs, kind="stable")[:FOLLOWED]]
    return starts


def _cost_with(candidate: Candidate, place: Place, rows: ContactFilter) -> float:
    flt, theta = placed(candidate, place, rows)
    return flt.run(theta).cost


def placed(candidate: Candidate, place: Place, rows: ContactFilter) -> tuple[ContactFilter, Array]:
    """Filter and θ of the candidate with a further inertia there."""
    theta, flt = candidate.theta.copy(), candidate.over(rows)
    flt = replace(flt, fourth_behind=place.behind) if place.fourth else replace(flt, behind=place.behind)
    theta[place.free] = np.log([place.share, place.compliance, place.loss])
    return flt, theta


def with_further_inertias(
    pairs: Sequence[tuple[Candidate, Place]], rows: ContactFilter, box: Box
) -> list[Candidate]:
    """Candidates with a further inertia, each at its place, over some rows, the lowest first."""
    begun = []
    for one, place in pairs:
        flt, theta = placed(one, place, rows)
        begun.append(replace(one, theta=theta, flt=flt, free=sorted({*one.free, *place.free})))
    return coming_down(begun, rows, box)


def coming_down(begun: Sequence[Candidate], rows: ContactFilter, box: Box) -> list[Candidate]:
    """Ends of descents over some rows that come down from a higher noise level together, the lowest first: the better
    half of them goes on to the next one."""
    if not begun:
        return []
    found, level = list(begun), first_level(rows, begun[0].theta, FITTED_LEVEL)

    def lowered(one: Candidate) -> Candidate:
        flt = replace(one.flt, level=level)
        theta, cost = minimise(flt, one.theta, one.free, box, STEPS)
        return replace(one, theta=theta, cost=cost, flt=flt)

    while True:
        found = sorted(side_by_side(lowered, found), key=cost_of)
        if level <= rows.floor:
            return found
        found = found[: max(len(found) // 2, LAST)]
        level = max(level / LEVEL_FACTOR, rows.floor)


def with_dropped(candidate: Candidate, which: Sequence[int] = (*THIRD, *FOURTH)) -> Candidate:
    """The candidate without its further inertias; its cost is still that with them."""
    theta = candidate.theta.copy()
    theta[[*which]] = -np.inf
    free = [place for place in candidate.free if place not in which]
    flt = replace(candidate.flt, fourth_behind=False)
    if set(THIRD) <= {*which}:
        flt = replace(flt, behind=False)
    return replace(candidate, theta=theta, free=free, flt=flt)


def without_last_inertia(candidate: Candidate, box: Box) -> Candidate:
    """The candidate fitted without its fourth inertia, or without its third if it has no fourth."""
    dropped = with_dropped(candidate, FOURTH if has_fourth(candidate) else THIRD)
    return polish(dropped, dropped.flt, box)


def has_fourth(candidate: Candidate) -> bool:
    return bool(np.isfinite(candidate.theta[FOURTH[0]]))

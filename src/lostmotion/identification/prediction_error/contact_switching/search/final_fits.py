"""What the search has found over more rows: the best few fitted anew, and what beside them may be right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...innovations import NAMES as TOLD
from ..estimate import CORE, Estimate, told
from ..intervals.further_inertias import room_for_further_inertias
from ..intervals.refits import disagreement
from ..intervals.unseen_rise import room_for_unseen_rise
from ..likelihood import Candidate, cost_of, side_by_side
from ..likelihood_ratio import clearly_better, simplest
from ..moves.backlash_scan import with_better_backlash
from ..moves.choices import other_parts, under_other_laws
from ..selection import apart, plausible
from .descents import NEAR, POLISHED, Search, judged
from .telling_rows import most_telling

#: Steps of the model in one pass of the last fits at most; a row takes one, or more where a contact or a friction
#: changes (numerics: some 4 ms).
STEPS = 30_000
#: Part of the rows that shows which fits are clearly worse (numerics).
PART = 4


def estimate(search: Search, found: Sequence[Candidate]) -> Estimate | None:
    """What the best candidate tells; None where that is no inertia, stiffness or backlash, or no cost is finite.

    The few that predict more rows best are fitted to these. Where the best of them is the drive, nothing else is looked
    for, and no fit with other rows or more noise would tell otherwise.
    """
    others = plausible(found)
    if not np.isfinite(others[0].cost):
        return None
    search.reached("the best over more rows")
    best = simplest(others)
    rows = most_telling(best, search.flt, _rows(best))
    few = side_by_side(lambda one: judged(one, one.over(rows)), apart(others, NEAR))
    few = sorted(few, key=cost_of)[:POLISHED]
    finished, shifts = search.polished(few, rows), np.zeros(len(TOLD))
    best = simplest(finished)
    if not search.is_the_drive(best):
        best, finished, under_laws = _finished(search, few[0], finished)
        search.reached("intervals")
        shifts = disagreement(best, under_laws, search.box)
    room = np.hypot(room_for_further_inertias(best, finished, search.box), room_for_unseen_rise(best))
    result = told(best, plausible(finished), shifts, room, search.box, search.fixed)
    return result if np.any(np.isfinite(result.half[CORE])) else None


def _rows(best: Candidate) -> int:
    """As many as one pass may take."""
    return int(STEPS * best.flt.rows / best.flt.run(best.theta).steps)


def _finished(
    search: Search, begun: Candidate, found: Sequence[Candidate]
) -> tuple[Candidate, list[Candidate], list[Candidate]]:
    """The simplest that none is better than of the candidates ``found`` over many rows, of the best of them under other
    laws, with other backlashes and with parts that it lacks; all of these; and its fits under other laws.

    ``begun``: that of the search which predicts these rows best.
    """
    box = search.box
    afresh = _not_worse(search, [search.with_friction_of_the_start(begun)], begun)
    found = [*found, *search.polished(afresh)]
    best = min(found, key=cost_of)
    laws = [best, *_under_other_laws(search, best)]
    found += laws[1:]
    best = min(found, key=cost_of)
    if not search.is_the_drive(best):
        # A gap that the few rows of the search do not cross, or hardly, may have any size.
        found += search.with_any_backlash(best, best.flt, [best.flt.law])
        found += search.polished(with_better_backlash(min(found, key=cost_of), box))
        best = min(found, key=cost_of)
    parts = other_parts(best, search.coarse, box, search.intermediate)
    added = _not_worse(search, side_by_side(lambda part: part(best), parts), best)
    found = search.split([*found, *search.polished(added)])
    best = simplest(found)
    if all(one is not best for one in laws):
        # Fits under other laws that lack what the best has found since, or have more, differ from it by that as well.
        laws = [best, *_under_other_laws(search, best)]
        found += laws[1:]
        best = simplest(laws)
    return best, found, [one for one in laws if one is not best]


def _under_other_laws(search: Search, best: Candidate) -> list[Candidate]:
    """Fits that begin at the best, but for those that it is clearly better than over a part of the rows."""
    return search.polished(_not_worse(search, under_other_laws(best), best))


def _not_worse(search: Search, begun: Sequence[Candidate], best: Candidate) -> list[Candidate]:
    """The candidates fitted to a part of the best's rows, but for those that it is clearly better than there; over all
    of its rows then."""
    rows = best.flt.liveliest(best.flt.rows // PART)
    beside = judged(best, best.over(rows))
    kept = [one for one in search.polished(begun, rows) if not clearly_better(beside, one)]
    return [judged(one, one.over(best.flt)) for one in kept]

"""What the search has found over more rows: the best few fitted anew, and what beside them may be right."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..estimate import CORE, Estimate, told
from ..filter import ContactFilter
from ..intervals.further_inertias import room_for_further_inertias
from ..intervals.refits import disagreement
from ..intervals.unseen_rise import room_for_unseen_rise
from ..likelihood import Candidate, cost_of, side_by_side
from ..likelihood_ratio import simplest
from ..moves.backlash_scan import with_better_backlash
from ..moves.choices import other_parts
from ..selection import apart, plausible
from .descents import NEAR, POLISHED, Search, judged
from .telling_rows import most_telling

#: Steps of the model in one pass of the last fits at most; a row takes one, or more where a contact or a friction
#: changes (numerics: some 4 ms).
STEPS = 30_000


def estimate(search: Search, found: Sequence[Candidate]) -> Estimate | None:
    """What the best candidate tells; None where that is no inertia, stiffness or backlash, or no cost is finite."""
    others = plausible(found)
    if not np.isfinite(others[0].cost):
        return None
    search.reached("the best over more rows")
    best = simplest(others)
    best, finished, under_laws = _finished(search, others, most_telling(best, search.flt, _rows(best)))
    search.reached("intervals")
    shifts = disagreement(best, under_laws, search.box)
    room = np.hypot(room_for_further_inertias(best, finished, search.box), room_for_unseen_rise(best))
    result = told(best, plausible(finished), shifts, room, search.box, search.fixed)
    return result if np.any(np.isfinite(result.half[CORE])) else None


def _rows(best: Candidate) -> int:
    """As many as one pass may take."""
    return int(STEPS * best.flt.rows / best.flt.run(best.theta).steps)


def _finished(
    search: Search, others: Sequence[Candidate], flt: ContactFilter
) -> tuple[Candidate, list[Candidate], list[Candidate]]:
    """The simplest that none is better than of all candidates over more rows; all of these; its fits under other laws.

    They are the few that predict these rows best, fitted to them; then the best of these under other laws, with other
    backlashes and with parts that it lacks.
    """
    box = search.box
    few = side_by_side(lambda one: judged(one, one.over(flt)), apart(others, NEAR))
    few = sorted(few, key=cost_of)[:POLISHED]
    found = search.polished([*few, search.with_friction_of_the_start(few[0])])
    laws = _of_each_law(search, min(found, key=cost_of))
    found += laws[1:]
    best = min(found, key=cost_of)
    if not search.is_the_drive(best):
        # A gap that the few rows of the search do not cross, or hardly, may have any size.
        found += search.with_any_backlash(best, flt, [best.flt.law])
        found += search.polished(with_better_backlash(min(found, key=cost_of), box))
        best = min(found, key=cost_of)
    begun = side_by_side(lambda part: part(best), other_parts(best, search.coarse, box, search.intermediate))
    found = search.split([*found, *search.polished(begun, flt)])
    best = simplest(found)
    if all(one is not best for one in laws):
        # Fits under other laws that lack what the best has found since, or have more, differ from it by that as well.
        laws = _of_each_law(search, best)
        found += laws[1:]
        best = simplest(laws)
    return best, found, [one for one in laws if one is not best]


def _of_each_law(search: Search, best: Candidate) -> list[Candidate]:
    """The candidate, and the fits under the other laws that begin at it."""
    return [best, *search.under_other_laws(best)]

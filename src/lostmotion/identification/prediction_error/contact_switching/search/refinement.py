"""A fit that stands although its model lacks an inertia: what a fourth one tells of the drive."""

from __future__ import annotations

from ..estimate import EXPLAINED, Estimate, told
from ..fitted import intervals, within_intervals
from ..intervals.further_inertias import room_for_further_inertias
from ..intervals.refits import disagreement
from ..likelihood import cost_of
from ..likelihood_ratio import clearly_better
from ..moves.choices import under_other_laws
from ..selection import plausible
from ..structures.shaft_inertias import has_fourth
from ..verdict import Fit
from .descents import Search


def with_a_fourth_inertia(search: Search, fit: Fit) -> Estimate | None:
    """What the likeliest drive with a fourth inertia tells; None where the fit needs none, or that explains no more.

    The descents begin at the fit, over some torsional periods: nothing is looked for elsewhere.
    """
    if search.intermediate is None:
        return None
    part, box, fixed = search.part, search.box, search.fixed
    own = within_intervals(part, fit.predictor, fit.stage, fit.told, box, fixed)
    if abs(own.cost) < EXPLAINED:
        return None
    three = search.with_all_structures(own, intervals(part, fit.stage, fit.told, box))
    found = [three, *search.fourths([three])]
    # Of all choices the law of the contact matters most beside inertias that are right.
    found += search.polished(under_other_laws(min(found, key=cost_of)))
    best = min(found, key=cost_of)
    if not has_fourth(best) or abs(best.cost) >= EXPLAINED or not clearly_better(best, three):
        return None
    room = room_for_further_inertias(best, [], box)
    return told(best, plausible(found), disagreement(best, [], box), room, box, fixed)

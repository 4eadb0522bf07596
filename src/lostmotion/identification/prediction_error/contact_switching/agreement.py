"""Whether the observer of constant gain is believed, by the likelihood of the contact-switching filter."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from .. import problems as problem
from ..gain_schedule import Progress, Stage
from ..gap.absent_gap import NEEDED
from ..identifiability import Told
from ..innovations import NAMES, Predictor
from .estimate import APART, EXPLAINED, by_chance, scatter
from .filter import ContactFilter
from .fitted import intervals, within_intervals
from .likelihood import Candidate, cost_of
from .likelihood_ratio import CHANCE_RIGID, alike, clearly_better
from .moves.choices import with_other_torque
from .search.descents import Search
from .search.final_fits import estimate
from .search.refinement import with_a_fourth_inertia
from .search.room import NOISE_ALONE, POLES
from .verdict import Fit, Outcome

Array = NDArray[np.float64]

#: A rigid drive predicts so much worse than a fit whose torsion stands well above the noise, in the logarithm of the
#: innovations (calibrated on development drives 0 to 30: where it is less, another fit may predict as well).
TORSION = 0.25
#: Nothing is told where innovations are more than so many times the sensor's noise (calibrated on the virtual rigs,
#: whose four inertias make them twice as large: whatever makes them three times as large is not known well enough).
UNEXPLAINED = 3.0
#: Rows over which a fit must have the likeliest values (numerics: five times those of the first look; 0.4 s).
ROWS = 10_000


def confirmed(
    predictor: Predictor,
    stage: Stage,
    told: Told,
    start: Drivetrain,
    fixed: Collection[str],
    slow: tuple[float, float],
    compared: list[Candidate],
    say: Progress,
) -> Outcome:
    """The fit as it is where the contact-switching filter agrees; what that tells where it does not.

    Its cost is a likelihood. First a few torsional periods are looked at, then more rows: on drives like the virtual
    rig the fit stands. If it has an intermediate inertia that does not explain the recording, a fourth one tells the
    drive; else that is all. Otherwise it stands if no descent from any start predicts clearly better or knows its
    values better, nor a rigid drive as well. Where one does, or the fit tells nothing, its own values are told if they
    stand out. Else the difference is part of the intervals, and too large a one leaves nothing.

    ``slow`` is what the slow motion tells of the total inertia, see ``total_inertia.of_slow_motion``. ``compared`` gets
    all candidates that were looked at, first that whose values are told; none where the fit stood at first sight.
    ``say`` hears how far it is.
    """
    fit = Fit(predictor, stage, told, start)
    flt = ContactFilter.of(predictor, POLES * start.pole_frequency)
    search = Search.of(flt, start, predictor.drivetrain(told.theta), fixed, predictor.joint_piece, slow)
    search = replace(search, say=say)
    search.reached("comparing with the contact-switching filter")
    if stage.free and _stands(search.glimpse(), fit):
        four = with_a_fourth_inertia(search, fit)
        # What says otherwise began at the fit: it has left its minimum, and is no reason for another search.
        if four is None or fit.contradicts(four):
            return fit.stays()
        compared.append(four.best)
        return fit.with_the_drive_of(four)
    own = within_intervals(search.part, predictor, stage, told, search.box, fixed)
    rivals = search.rivals(own)
    inside = intervals(search.part, stage, told, search.box)
    own = min(own, search.with_all_structures(own, inside), key=cost_of)
    own = with_other_torque(own, inside) or own
    best = min(own, *rivals, key=cost_of)
    rigid = search.rigid(best)
    compared += [own, *rivals, rigid]
    if not clearly_better(best, rigid, CHANCE_RIGID):
        return fit.nothing(problem.rigid())
    better, explained = [one for one in rivals if clearly_better(one, own)], abs(best.cost) < EXPLAINED
    # Whatever predicts alike may be right as well.
    others = [*better, *(one for one in rivals if alike(one, best))]
    excess = 0.0 if explained else fit.excess(flt)
    doubtful = bool(better) or not stage.free or excess > UNEXPLAINED or fit.contradicted_by(others)
    if doubtful or explained:
        found = estimate(search, rivals)
        if found is not None and (doubtful or fit.knows_less_than(found)):
            compared.insert(0, found.best)
            wrong = fit.wrong_minimum(found) if doubtful else None
            return fit.nothing(wrong) if wrong else fit.replaced_by(found)
        if found is not None:
            others.append(found.best)
    if excess > UNEXPLAINED:
        return fit.nothing(problem.unexplained(excess, UNEXPLAINED))
    if not stage.free:
        return fit.stays()
    return fit.with_room_for(others, _chance_over_all_rows(best) if explained else None)


def _chance_over_all_rows(best: Candidate) -> Array:
    """(8,) half widths by chance of a candidate, were it fitted to the whole recording."""
    whole = best.flt.whole or best.flt
    return by_chance(best, scatter(best)[1]) * np.sqrt(best.flt.rows / whole.rows)


def _stands(search: Search, fit: Fit) -> bool:
    """Whether the fit is sure of inertias, stiffness, backlash and Coulomb friction, near what the nameplate says,
    torsion is well above the noise, and nothing says otherwise: near it, where more than noise is left, nor over more
    rows, where it explains these."""
    told = {NAMES[i] for i in fit.stage.free} | set(search.fixed)
    # A load torque that the fit does not have leaves it unsure of Coulomb friction.
    sure = fit.core | (np.array(fit.stage.free) == NAMES.index("coulomb"))
    if not told.issuperset(NEEDED) or np.any(fit.told.half[sure] > APART):
        return False
    if fit.excess(search.flt) > UNEXPLAINED or fit.beyond_nameplate():
        return False
    own = within_intervals(
        search.part, fit.predictor, fit.stage, fit.told, search.box, search.fixed, NOISE_ALONE
    )
    if search.rigid().cost < own.cost + TORSION:
        return False
    if abs(own.cost) >= NOISE_ALONE and _better_near(search, fit, own):
        return False
    return not _more_rows_say_otherwise(search, fit)


def _better_near(search: Search, fit: Fit, own: Candidate) -> bool:
    """Whether a descent from the fit or the nameplate, or a third inertia, is better and says otherwise."""
    descents, thirds = search.near(own)
    if np.any(fit.shift([one for one in thirds if clearly_better(one, own)])[fit.core] > 0.0):
        return True
    # Descents may have friction at either end. Over so few rows hardly anything is clearly better: friction at the
    # wrong end never was.
    better = [one for one in descents if one.cost < own.cost and not alike(own, one, 0.0)]
    return bool(np.any(fit.shift(better)[fit.core | fit.friction] > 0.0))


def _more_rows_say_otherwise(search: Search, fit: Fit) -> bool:
    """Whether the fit is surer of an inertia, a stiffness or a backlash than the likelihood allows, or others outside
    of its intervals are clearly likelier. These come from all rows: a few torsional periods do not show it.

    The fit has no load torque that changes: it takes one for motion of the load, and is far too sure of it.
    """
    more = replace(search, part=search.flt.liveliest(ROWS))
    own = within_intervals(more.part, fit.predictor, fit.stage, fit.told, search.box, search.fixed)
    if abs(own.cost) >= EXPLAINED:
        return False  # what the model lacks leads any values astray
    if fit.surer_than(by_chance(own, scatter(own)[1])):
        return True
    freed = more.freed(own)
    return clearly_better(freed, own) and bool(np.any(fit.shift([freed])[fit.core] > 0.0))

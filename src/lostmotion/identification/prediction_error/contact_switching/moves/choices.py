"""A candidate with one of its choices made otherwise, or with a part that it does not have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from ..filter import LAWS, ContactFilter
from ..likelihood import Box, Candidate, polish
from ..likelihood_ratio import alike
from ..parameter_vector import INDEX, pole_of
from ..structures.no_gap import PLACE, bare
from ..structures.rising_friction import FADES, may_rise, with_rising_friction
from ..structures.shaft_inertias import Place, has_fourth, places, with_further_inertias
from ..told import lag

Choice = Callable[[Candidate], Candidate]

#: Parts of lag and delay together that are the lag, and their sum in torsional periods from which on it matters
#: (numerics: from one of these a descent leads to the drive's, from far off it does not).
SPLITS, LATE = (0.1, 0.3, 0.5, 0.7, 0.9), 0.05


def with_other_torque(candidate: Candidate, box: Box) -> Candidate | None:
    """The candidate with the torque as a ramp instead of held, or the other way; None where that is no better."""
    other = polish(candidate, replace(candidate.flt, ramp=not candidate.flt.ramp), box)
    return other if other.cost < candidate.cost and not alike(candidate, other) else None


def other_choices(best: Candidate, box: Box) -> list[Choice]:
    """Each makes one choice otherwise than the best: how the torque goes between rows, how much of its lateness is a
    lag, how the load torque changes, the law of the contact, whether there is a gap, and whether friction rises towards
    rest."""

    def with_filter(change: dict[str, Any]) -> Choice:
        return lambda one: replace(one, flt=replace(one.flt, **change))

    def rising(fade: float) -> Choice:
        return lambda one: with_rising_friction(one, fade, box)

    changes: list[dict[str, Any]] = [{"ramp": not best.flt.ramp}, {"drifts": not best.flt.drifts}]
    if np.isfinite(best.theta[PLACE]):
        changes += [{"law": law} for law in LAWS if law != best.flt.law]
    gapless = [bare] if PLACE in best.free else []
    splits = [partial(with_split, part=part) for part in SPLITS if is_late(best)]
    rises = [rising(fade) for fade in FADES if may_rise(best)]
    return [*map(with_filter, changes), *gapless, *splits, *rises]


def under_other_laws(best: Candidate) -> list[Candidate]:
    """As it is under the other laws of the contact, and with the torque between rows otherwise."""
    laws = [replace(best, start=law, flt=replace(best.flt, law=law)) for law in LAWS if law != best.flt.law]
    return [*laws, replace(best, start="other torque", flt=replace(best.flt, ramp=not best.flt.ramp))]


def is_late(candidate: Candidate) -> bool:
    """Whether the torque acts so late that it matters how much of that is a lag, the rest a delay."""
    return INDEX["delay"] in candidate.free and lag(candidate) > LATE / pole_of(candidate.theta)


def with_split(candidate: Candidate, part: float) -> Candidate:
    """The candidate with this part of lag and delay together as its lag: they smear the torque and shift it."""
    both = lag(candidate)
    theta = candidate.flt.changed(candidate.theta, lag=part * both, delay=(1.0 - part) * both)
    return replace(candidate, theta=theta)


def other_parts(
    best: Candidate, rows: ContactFilter, box: Box, known: tuple[float, float] | None
) -> list[Choice]:
    """Each gives the best, over some rows, a part that it does not have: a third inertia before or behind the gap (one
    that it has goes to the other side), a fourth beside a third, or friction that rises towards rest. What predicts as
    well may be right.

    ``known``: share and compliance of a third inertia before the gap, if they were found.
    """

    def further(side: list[Place]) -> Choice:
        def add(one: Candidate) -> Candidate:
            tried = with_further_inertias([(one, place) for place in side], rows, box)
            return replace(tried[0], start="further inertia")

        return add

    def rising(fade: float) -> Choice:
        return lambda one: replace(
            with_rising_friction(replace(one, flt=replace(one.over(rows), level=one.flt.level)), fade, box),
            start="rising friction",
        )

    has, sides = Place.of(best), []
    for behind in (False, True):
        if has is None or (behind != has.behind and not has_fourth(best)):
            sides.append([Place(*known)] if known and not behind else places(best, rows, [behind]))
        if has is not None and not has_fourth(best):
            sides.append(places(best, rows, [behind], fourth=True))
    return [*map(further, sides), *(rising(fade) for fade in FADES if may_rise(best))]

"""Whole descents of the contact-switching filter from several starts and in several structures, judged by one cost."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..estimate import EXPLAINED, sharp
from ..filter import LAWS, ContactFilter
from ..likelihood import (
    FIRST_LEVEL,
    FITTED_LEVEL,
    Box,
    Candidate,
    cost_of,
    descend,
    minimise,
    polish,
    side_by_side,
)
from ..likelihood_ratio import CHANCE_RIGID, alike, clearly_better
from ..moves.backlash_scan import with_best_backlashes, with_other_backlash
from ..moves.choices import Choice, other_choices
from ..moves.random_moves import PATIENCE, wandering
from ..parameter_vector import FRICTIONS, INDEX
from ..selection import ELSEWHERE, apart
from ..starts import grid
from ..starts.from_drivetrain import (
    LONGEST_LAG,
    RESPONSE,
    lag_and_delay,
    rigid_start,
)
from ..starts.race import race
from ..starts.torque_delay import torque_delay
from ..structures import grid_of_three
from ..structures.no_gap import OFFSET, PLACE, bare
from ..structures.shaft_inertias import (
    FOURTH,
    THIRD,
    Place,
    coming_down,
    has_fourth,
    places,
    with_further_inertias,
)
from ..structures.softest_shaft import split_at_the_softest_shaft
from .room import FAR, KNOWN, Room

Array = NDArray[np.float64]

#: So many candidates that are elsewhere get a third inertia (numerics: a descent with one comes from about so far).
FEW = 3
#: Starts that get a third inertia as they are.
RAW = ("nameplate", "fitted")
#: Candidates that differ by less than this, in all logarithms or in the cost, come to the same over more rows
#: (numerics: a quarter of what counts).
NEAR = 0.05
#: Steps from the fit's likeliest values without its intervals (numerics).
FREED_STEPS = 10
#: What a friction that the fit does not have starts with, over its usual start (numerics).
LITTLE = 10.0
#: Ends of the race that get another backlash; descents that go on to the end (numerics).
SCANNED, POLISHED = 5, 3
#: Rounds of random moves without a lower cost where the drive seems known (numerics: one or two left a wrong minimum).
PATIENCE_KNOWN = 2


class Search(Room):
    """Whole descents, their order, and what is made of their ends."""

    def descent(self, name: str, gap: bool = True) -> Candidate:
        """From one of the starts, with its gap or without."""
        first = FITTED_LEVEL if name == "fitted" else FIRST_LEVEL
        uncharged = replace(self.part, charged=False)
        begun = self.raw(name) if gap else bare(self.raw(name))
        return judged(descend(name, uncharged, begun.theta, begun.free, self.box, first), self.part)

    def from_grid(self) -> list[Candidate]:
        """The best of a race from a coarse grid, with any backlash."""
        # Innovations that are too large are divided out: charged, what is far from the drive does not come through.
        rows = replace(self.coarse, charged=False)
        ends = race(grid.candidates(rows, self.start, self.fixed, self._delays()), rows, self.box)
        few = apart(ends, ELSEWHERE)[:SCANNED]
        few = apart(sorted([*few, *with_other_backlash(few, self.box)], key=cost_of), ELSEWHERE)[:SCANNED]
        numbered = [replace(one, start=f"grid {number}") for number, one in enumerate(few)]
        return self.polished(numbered, self.part)

    def from_grid_of_three(self, found: Sequence[Candidate]) -> list[Candidate]:
        """The best of descents from a grid with a gap and a third inertia: alone, neither may lead to the drive."""
        if self.ended(found):
            return []
        self.reached("a grid of three inertias")
        two = min((one for one in found if Place.of(one) is None), key=cost_of)
        rows = replace(self.coarse, charged=False)
        begun = grid_of_three.candidates(two, rows, self.start, self.fixed)
        few = apart(coming_down(begun, rows, self.box))[:FEW]
        return self.polished(few, self.part)

    def _delays(self) -> list[Array]:
        """θ with each lag and delay that the recording suggests."""
        found = [self.response, self.begun["fitted"]]
        delay = torque_delay(self.flt, self.start.pole_frequency, LONGEST_LAG)
        if delay is not None and "lag" not in self.fixed:
            found.append(self.flt.changed(found[1], **lag_and_delay(delay, self.flt.dt)))
        return found

    def rigid(self, like: Candidate | None = None) -> Candidate:
        """One inertia with friction and lag, and all its choices: how the torques change, friction that rises towards
        rest; beside another candidate with its unknown load torque."""
        theta, free = rigid_start(self.flt, self.start)
        flt = self.part
        if like is not None:
            flt = replace(flt, ramp=like.flt.ramp, drifts=like.flt.drifts)
            theta[INDEX["torque_rate"]] = like.theta[INDEX["torque_rate"]]
        found = [polish(descend("rigid", flt, theta, free, self.box), flt, self.box)]
        return min([*found, *self.otherwise(found)], key=cost_of)

    def with_all_structures(self, fit: Candidate, box: Box) -> Candidate:
        """The fit with friction at both ends, delay and a third inertia's own damping, within a box."""
        # Friction that the fit does not have from a little on, so that it is not left.
        theta, fitted = fit.theta.copy(), self.begun["fitted"]
        for place in (INDEX[name] for name in FRICTIONS):
            theta[place] = theta[place] or fitted[place] / LITTLE
        theta = np.where(np.isfinite(theta), theta, fitted - np.log(LITTLE))
        third = [INDEX["loss"]] if INDEX["share"] in fit.free else []
        free = sorted({*self.free, *fit.free, *third})
        theta, cost = minimise(self.part, theta, free, box, FREED_STEPS)
        return polish(replace(fit, theta=theta, cost=cost, free=free), self.part, box)

    def freed(self, fit: Candidate) -> Candidate:
        """From the fit's likeliest values, without its intervals."""
        return self.with_all_structures(replace(fit, start="freed"), self.box.including(fit.theta, FAR))

    def near(self, fit: Candidate) -> tuple[list[Candidate], list[Candidate]]:
        """Descents from the fit and from the nameplate, both with a gap if the fit has one; and the fit with a third
        inertia if it has none, else freed if it explains the recording: one that lacks a fourth is led astray."""
        gap = bool(np.isfinite(fit.theta[INDEX["backlash"]]))
        found = self.polished(side_by_side(lambda name: self.descent(name, gap), ["fitted", "nameplate"]))
        if not self.intermediate:
            return found, self.thirds([fit])
        return found, [self.freed(fit)] if abs(fit.cost) < EXPLAINED else []

    def _third(self, candidate: Candidate, place: Place) -> Candidate:
        found = with_further_inertias([(candidate, place)], self.coarse, self.box)[0]
        return polish(found, replace(candidate.flt, behind=place.behind), self.box)

    def thirds(self, found: Sequence[Candidate], raw: Sequence[Candidate] = ()) -> list[Candidate]:
        """With a third inertia: the best few and some raw starts from every place; then others where the best has it.

        Without a third inertia that a drive has, descents end far from it: those that begin with one need no more than
        a nameplate.
        """
        fits = sorted(found, key=cost_of)
        # How the torque goes between rows makes up for a third inertia: the best is tried with either.
        few = apart(fits, ELSEWHERE)[:FEW]
        other = replace(fits[0], flt=replace(fits[0].flt, ramp=not fits[0].flt.ramp))
        pairs = [(one, place) for one in (*few, other, *raw) for place in places(one, self.coarse)]
        best = self.with_inertias(pairs)
        place = Place.of(min(best, key=cost_of))
        if place is None or alike(fits[0], min(best, key=cost_of)):
            return best
        return best + side_by_side(lambda one: self._third(one, place), apart(fits)[:POLISHED])

    def fourths(self, found: Sequence[Candidate]) -> list[Candidate]:
        """With a fourth inertia, if the best has a third: four that are taken for three end far from the drive."""
        best = min(found, key=cost_of)
        if Place.of(best) is None or has_fourth(best):
            return []
        self.reached("a fourth inertia")
        return self.with_inertias([(best, place) for place in places(best, self.coarse, fourth=True)])

    def with_inertias(self, pairs: Sequence[tuple[Candidate, Place]]) -> list[Candidate]:
        """The best few of descents from candidates with one inertia more, each at its place."""
        few = apart(with_further_inertias(pairs, self.coarse, self.box))[:FEW]
        return self.polished(few, self.part)

    def rivals(self, fit: Candidate) -> list[Candidate]:
        """Descents from every start, the best of them with fitted rates; from a grid, unless one is sharp; from the fit
        without its intervals; and from where random moves lead. Where one is the drive, nothing else is looked for."""
        self.reached("descents from nameplate and fit")
        found = side_by_side(self.descent, [*self.begun, RESPONSE])
        found += self.polished(_best_elsewhere(found))
        if self.is_the_drive(min(found, key=cost_of)):
            return found
        if not sharp(min(found, key=cost_of)):
            self.reached("a race from a grid")
            found += self.from_grid()
        best = min(found, key=cost_of)
        rigid = self.rigid(best)
        if rigid.cost < KNOWN and not clearly_better(best, rigid, CHANCE_RIGID):
            return found  # no torsion shows
        self.reached("other torques, contact laws and frictions")
        found += self.otherwise(found, _best_elsewhere(found))
        found.append(self.freed(fit))
        for step in (self.thirds_from_raw, self.from_grid_of_three, self.fourths, self.with_moves_and_gaps):
            if self.is_the_drive(min(found, key=cost_of)):
                break
            found += step(found)
        return self.split(found)

    def thirds_from_raw(self, found: Sequence[Candidate]) -> list[Candidate]:
        """With a third inertia, from the best few and from raw starts."""
        self.reached("a third inertia")
        return self.thirds(found, [self.raw(name) for name in RAW])

    def with_moves_and_gaps(self, found: Sequence[Candidate]) -> list[Candidate]:
        """Where random moves of the best lead; then gaps of any size, and random moves of what these found."""
        more = self.with_random_moves(found)
        before = min([*found, *more], key=cost_of)
        self.reached("gaps of any size")
        more += self.with_other_gaps([*found, *more])
        if min([*found, *more], key=cost_of) is not before:
            more += self.with_random_moves([*found, *more])
        return more

    def with_random_moves(self, found: Sequence[Candidate]) -> list[Candidate]:
        """Where random moves of the best lead, and its other choices then; a few moves where the drive seems known."""
        best = min(found, key=cost_of)
        if self.nothing_left(best):
            return []
        self.reached("random moves")
        free, patience = {*self.free, *THIRD, *FOURTH}, PATIENCE_KNOWN if self.ended(found) else PATIENCE
        more = wandering(best, self.part, self.box, free, lambda: self.long, patience)
        if min(more, key=cost_of, default=best).cost < best.cost:
            more += self.otherwise([*found, *more])
        return more

    def with_other_gaps(self, found: Sequence[Candidate]) -> list[Candidate]:
        """The best with a backlash of any size, and with its other choices then, as long as that is better."""
        more: list[Candidate] = []
        while PLACE in self.free and not self.ended([*found, *more]):
            best = min([*found, *more], key=cost_of)
            better = min(self.with_any_backlash(best, self.coarse), key=cost_of, default=best)
            if alike(best, better, 0.0):
                break
            more += [better, *self.otherwise([better])]
        return more

    def with_any_backlash(
        self, best: Candidate, rows: ContactFilter, laws: Collection[str] = tuple(LAWS)
    ) -> list[Candidate]:
        """With the backlash that does best of those of any size, as it is and afresh; none where no gap is fitted."""
        gap = {PLACE, OFFSET} & {*self.free}
        if PLACE not in gap:
            return []
        scans = [with_best_backlashes(best, rows, self.box, gap, afresh, laws) for afresh in (False, True)]
        return self.polished([scan[0] for scan in scans if scan])

    def otherwise(self, found: Sequence[Candidate], others: Sequence[Candidate] = ()) -> list[Candidate]:
        """The best with one of its choices made otherwise, as long as that is better; then the others likewise.

        One round at least, however long the search has taken.
        """
        more: list[Candidate] = []
        while True:
            best = min([*found, *more], key=cost_of)
            choices = other_choices(best, self.box)
            tried = self._chosen([(choice, best) for choice in choices])
            better = min(tried, key=cost_of)
            if better.cost >= best.cost or alike(best, better):
                return more
            choice = choices[tried.index(better)]
            more += [better, *self._chosen([(choice, one) for one in others])]
            if self.long:
                return more

    def with_friction_of_the_start(self, one: Candidate) -> Candidate:
        """With friction and constant torque of the nameplate's start.

        While the speed keeps its sign, friction of both ends and a constant torque, each far too large, make up for
        each other. No small step leads out of that over rows where it does not.
        """
        own = [place for place in map(INDEX.__getitem__, (*FRICTIONS, "torque_offset")) if place in self.free]
        theta = one.theta.copy()
        theta[own] = self.begun["nameplate"][own]
        return replace(one, theta=theta)

    def _chosen(self, pairs: Sequence[tuple[Choice, Candidate]]) -> list[Candidate]:
        return self.polished(side_by_side(lambda pair: pair[0](pair[1]), pairs))

    def split(self, found: Sequence[Candidate]) -> list[Candidate]:
        """With what is near the best divided at the softest shaft where no gap shows."""
        best = min(found, key=cost_of)
        return side_by_side(
            lambda one: split_at_the_softest_shaft(one, self.box) if one.cost < best.cost + NEAR else one,
            found,
        )


def _best_elsewhere(found: Sequence[Candidate]) -> list[Candidate]:
    """The best few that lie apart."""
    return apart(sorted(found, key=cost_of), ELSEWHERE)[:POLISHED]


def judged(found: Candidate, flt: ContactFilter) -> Candidate:
    """The end of a descent by its likelihood over other rows."""
    at = replace(flt, level=found.flt.level)
    return replace(found, cost=at.run(found.theta).cost, flt=at)

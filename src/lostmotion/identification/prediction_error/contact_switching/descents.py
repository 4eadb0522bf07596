"""Whole descents of the contact-switching filter from several starts and in several structures, judged by one cost."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from . import grid
from .estimate import BACKLASH, CORE, Estimate, distance, told
from .filter import INDEX, LAWS, ContactFilter, pole_of
from .likelihood import FIRST_LEVEL, Box, Candidate, descend, minimise, polish, side_by_side
from .likelihood_ratio import alike
from .refits import disagreement
from .slow_motion import SlowMotion
from .starts import free_places, rigid_start, starts, with_values

Array = NDArray[np.float64]

#: Torsional periods of the rows that the descents run over, and rows at least and at most; rows of the last fits
#: (numerics: a pass over them takes some 10 ms).
PERIODS, FEWEST, MOST, ROWS = 80, 3000, 10_000, 30_000
#: Poles up to this multiple of the nameplate's are stepped over finely enough (numerics: three either way).
POLES = 3.0
#: No parameter leaves its start by more than this factor (numerics).
FAR = 100.0
#: First noise level of a descent from values that were fitted already, see ``likelihood.FIRST_LEVEL`` (numerics).
FITTED_LEVEL = 0.003

#: Where a third inertia starts: its share of the motor's, and of the compliance (numerics).
SHARE, COMPLIANCE = 0.1, 0.3

#: Candidates that differ by less than this in all logarithms are one (numerics: below an interval).
SAME = 0.01

#: What is displaced, and by which factor either way, to see whether a descent comes back (numerics: a third is what the
#: grid leaves open; a backlash may be far off where it is small).
DISPLACED = {
    "inertia_motor": 1.5, "inertia_load": 1.5, "stiffness": 1.5, "backlash": 4.0, "share": 2.0, "compliance": 4.0,
}  # fmt: skip
#: Descents whose inertias, stiffness and backlash are within this, in the logarithm, have found the same (calibrated on
#: development drives: right values agree within a tenth).
AGAIN = 0.1
#: So many other starts lead there (calibrated on development drives 0 to 85: a wrong minimum was found from two starts
#: once, from three never).
OTHERS = 2
#: Excess of the innovations over the sensor's noise, as a logarithm, up to which the model explains the recording
#: (calibrated on development drives 0 to 49: below, errors are as large as the intervals say, above they are not).
EXPLAINED = 0.25
#: Cost below which nothing but the sensor's noise is left (numerics: innovations 2 % larger).
NOISE_ALONE = 0.02
#: Steps from the fit's likeliest values without its intervals (numerics).
FREED_STEPS = 10
#: What a friction that the fit does not have starts with, over its usual start (numerics).
LITTLE = 10.0
#: Part of the rows of a descent that show whether the fit stands, and rows at least (numerics: 20 torsional periods).
GLIMPSE, LEAST = 4, 2000
#: Steps from a point of the grid; descents that go on to the end; displacements of the best at most (numerics).
FIRST_STEPS, POLISHED, DISPLACEMENTS = 3, 6, 2


@dataclass(frozen=True, eq=False)
class Search:
    """What all descents of a recording have in common.

    Parameters
    ----------
    flt, part : ContactFilter
        Over the whole recording, and over the rows of the descents.
    start, fitted : Drivetrain
        Nameplate; what the observer of constant gain has found.
    fixed : names that keep the nameplate's value
    piece : share and compliance of a third inertia, if that was found
    begun : mapping of name → θ
        From where descents start.
    box : Box
    """

    flt: ContactFilter
    part: ContactFilter
    start: Drivetrain
    fitted: Drivetrain
    fixed: Collection[str]
    piece: tuple[float, float] | None
    begun: dict[str, Array]
    box: Box

    @classmethod
    def of(
        cls,
        flt: ContactFilter,
        start: Drivetrain,
        fitted: Drivetrain,
        fixed: Collection[str],
        piece: tuple[float, float] | None,
    ) -> Search:
        slow = SlowMotion.of(flt, start)
        flt = replace(flt, inertia=(slow.inertia, slow.half))
        begun = starts(flt, start, fitted, fixed)
        box = Box.around(flt, begun["nameplate"], FAR).including(begun["fitted"], FAR)
        rows = int(np.clip(PERIODS / (flt.dt * pole_of(begun["nameplate"])), FEWEST, MOST))
        return cls(flt, flt.liveliest(rows), start, fitted, fixed, piece, begun, box)

    def glimpse(self) -> Search:
        """The same over a few torsional periods."""
        return replace(self, part=self.flt.liveliest(max(LEAST, self.part.rows // GLIMPSE)))

    def descent(self, name: str) -> Candidate:
        """From one of the starts."""
        free, first = free_places(self.start, self.fixed), FITTED_LEVEL if name == "fitted" else FIRST_LEVEL
        return descend(name, self.part, self.begun[name], free, self.box, first)

    def from_grid(self) -> list[Candidate]:
        """Short descents from the best of each plane of the grid."""
        free = free_places(self.start, self.fixed)

        def short(numbered: tuple[int, Array]) -> Candidate:
            number, theta = numbered
            theta, run = minimise(self.part, theta, free, self.box, FIRST_STEPS)
            return Candidate(f"grid {number}", theta, run.cost, self.part, free)

        return side_by_side(short, list(enumerate(grid.best(self.part, self.start, self.fixed))))

    def rigid(self, like: Candidate | None = None) -> Candidate:
        """One inertia with friction and lag; the torque as another candidate takes it."""
        theta, free = rigid_start(self.flt, self.start)
        part = replace(self.part, ramp=like is not None and like.flt.ramp)
        return descend("rigid", part, theta, free, self.box)

    def with_all_structures(self, fit: Candidate, box: Box) -> Candidate:
        """The fit with friction at both ends, asymmetry and delay, within a box."""
        # Friction of the motor from a little on, so that the fit is not left.
        theta = np.where(np.isfinite(fit.theta), fit.theta, self.begun["fitted"] - np.log(LITTLE))
        free = sorted({*free_places(self.start, self.fixed), *fit.free})
        theta, run = minimise(self.part, theta, free, box, FREED_STEPS)
        return polish(replace(fit, theta=theta, cost=run.cost, free=free), self.part, box)

    def near(self, fit: Candidate) -> list[Candidate]:
        """What lies next to the fit: a descent from it, and with a third inertia if it has none."""
        found = self.descent("fitted")
        third = [] if self.piece else [_with_piece(fit, None, self.box)]
        return [polish(found, found.flt, self.box), *third]

    def rivals(self, fit: Candidate) -> list[Candidate]:
        """Descents from every start, the best of them with fitted rates; and from the fit without its intervals."""
        found = [*side_by_side(self.descent, list(self.begun)), *self.from_grid()]
        best = _apart(sorted(found, key=_cost))[:POLISHED]
        found += side_by_side(lambda one: polish(one, one.flt, self.box), best)
        if (otherwise := with_other_torque(min(found, key=_cost), self.box)) is not None:
            found += [otherwise, *side_by_side(lambda one: polish(one, otherwise.flt, self.box), best)]
        if not self.piece:
            found.append(_with_piece(fit, None, self.box))
        found.append(
            self.with_all_structures(replace(fit, start="freed"), self.box.including(fit.theta, FAR))
        )
        for _ in range(DISPLACEMENTS):
            before = min(found, key=_cost)
            found += self.displaced(before)
            if alike(before, min(found, key=_cost)):
                break
        return found

    def displaced(self, best: Candidate) -> list[Candidate]:
        """Descents from beside the best: they come back, show a better place, or one that predicts as well."""

        def beside(change: tuple[str, float]) -> Candidate:
            name, factor = change
            theta = best.theta.copy()
            theta[INDEX[name]] += np.log(factor)
            theta = np.clip(theta, self.box.lower, self.box.upper)
            return polish(replace(best, theta=theta), best.flt, self.box)

        names = [
            name for name in DISPLACED if INDEX[name] in best.free and np.isfinite(best.theta[INDEX[name]])
        ]
        changes = [(name, factor) for name in names for factor in (DISPLACED[name], 1.0 / DISPLACED[name])]
        return side_by_side(beside, changes)

    def estimate(self, found: Sequence[Candidate]) -> Estimate | None:
        """What the best of the candidates tell; None where it is not found again."""
        others = plausible(found)
        if not np.isfinite(others[0].cost):
            return None
        finished = _finished(others, self.flt.liveliest(ROWS), self.piece, self.box)
        best, under_laws = finished[0], [one for one in finished if one.start in LAWS]
        apart = disagreement(best, under_laws, self.box)
        estimate = told(best, [*plausible(finished), *others], apart, self.box, self.fixed)
        return self._found_again(estimate, others[0], found)

    def _found_again(
        self, estimate: Estimate, best: Candidate, found: Sequence[Candidate]
    ) -> Estimate | None:
        """The estimate where so many other starts lead there; half way from the nameplate is one more.

        They have to agree on inertias and stiffness; on the backlash as well for that to be told.
        """
        core = [i for i in CORE if np.isfinite(estimate.half[i])]
        if not core:
            return None

        def same(one: Candidate, places: Sequence[int]) -> bool:
            return bool(np.all(distance(one, best)[places] < AGAIN))

        def starts(places: Sequence[int]) -> set[str]:
            return {one.start for one in found if one.start != best.start and same(one, places)}

        shaft = [i for i in core if i != BACKLASH] or core
        others, all_of_it = starts(shaft), starts(core)
        if len(all_of_it) == OTHERS - 1:
            theta = 0.5 * (self.begun["nameplate"] + best.theta)
            again = descend("half way", best.over(self.part), theta, best.free, self.box)
            again = polish(again, again.flt, self.box)
            others |= {again.start} if same(again, shaft) else set()
            all_of_it |= {again.start} if same(again, core) else set()
        if len(others) < OTHERS:
            return None
        half = estimate.half.copy()
        if len(all_of_it) < OTHERS:
            half[BACKLASH] = np.inf
        return replace(estimate, half=half)


def _finished(
    others: Sequence[Candidate], flt: ContactFilter, piece: tuple[float, float] | None, box: Box
) -> list[Candidate]:
    """Over more rows: the best two, then the best under other laws and with a third inertia; the lowest comes first."""
    found = side_by_side(lambda one: polish(one, one.over(flt), box), _apart(others)[:2])
    best = min(found, key=_cost)
    laws = [law for law in LAWS if law != best.flt.law]
    found += side_by_side(lambda law: replace(polish(best, replace(best.flt, law=law), box), start=law), laws)
    found.append(_with_piece(min(found, key=_cost), piece, box))
    return sorted(found, key=_cost)


def with_other_torque(candidate: Candidate, box: Box) -> Candidate | None:
    """The candidate with the torque as a ramp instead of held, or the other way; None where that is no better."""
    other = polish(candidate, replace(candidate.flt, ramp=not candidate.flt.ramp), box)
    return other if other.cost < candidate.cost and not alike(candidate, other) else None


def _with_piece(candidate: Candidate, piece: tuple[float, float] | None, box: Box) -> Candidate:
    """The candidate with a third inertia on the shaft."""
    share, compliance = piece or (SHARE, COMPLIANCE)
    theta = with_values(candidate.theta, candidate.flt, share=share, compliance=compliance)
    one = replace(
        candidate,
        start="third inertia",
        theta=theta,
        free=sorted({*candidate.free, INDEX["share"], INDEX["compliance"]}),
    )
    return polish(one, candidate.flt, box)


def plausible(found: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that predict about as well as the best, which comes first."""
    found = sorted(found, key=_cost)
    return [one for one in found if alike(one, found[0])]


def _cost(one: Candidate) -> float:
    return one.cost


def _apart(found: Sequence[Candidate]) -> list[Candidate]:
    """Candidates whose inertias, stiffness, damping or backlash are no better one's."""
    kept: list[Candidate] = []
    for one in found:
        if all(np.max(distance(one, other)[:5]) > SAME for other in kept):
            kept.append(one)
    return kept

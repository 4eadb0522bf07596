"""Whole descents of the contact-switching filter from several starts and in several structures, judged by one cost."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ...statistics.block_covariance import sandwich, student_factor
from ..innovations import NAMES as TOLD
from ..model_error import model_allowance
from . import grid
from .filter import INDEX, LAWS, NAMES, ContactFilter, pole_of
from .likelihood import (
    FIRST_LEVEL,
    Box,
    Candidate,
    descend,
    inverse_hessian,
    minimise,
    polish,
    side_by_side,
)  # fmt: skip
from .likelihood_ratio import alike
from .starts import free_places, lag, rigid_start, starts, told_vector, with_values

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
#: What the model leaves unexplained is no noise: it may push a value one way in all rows. Part of it that does so
#: (calibrated on development drives 0 to 139 and calibration drives 10050 to 10103, 2026-11-22, see
#: docs/benchmarks/zoo.md: 95 % of 121 errors need 0.026 at most; twice that leaves room for drives unlike them).
COHERENT = 0.05
#: Steps from the fit's likeliest values without its intervals (numerics).
FREED_STEPS = 10
#: What a friction that the fit does not have starts with, over its usual start (numerics).
LITTLE = 10.0
#: Part of the rows of a descent that show whether the fit stands, and rows at least (numerics: 20 torsional periods).
GLIMPSE, LEAST = 4, 2000
#: Steps from a point of the grid; descents that go on to the end; displacements of the best at most (numerics).
FIRST_STEPS, POLISHED, DISPLACEMENTS = 3, 6, 2
#: Places of inertias, stiffness and backlash: what the others hang on.
CORE = [TOLD.index(name) for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]
#: A value is told if a cost this factor away would be clearly higher (numerics, as ``identifiability.NOT_EXCITED``).
NOT_EXCITED = 3.0


@dataclass(frozen=True, eq=False)
class Estimate:
    """Parameters of ``innovations.NAMES``: vector (8,), half widths (8,; infinite: not identified), best candidate."""

    theta: Array
    half: Array
    covariance: Array
    best: Candidate


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

    def rigid(self) -> Candidate:
        """One inertia with friction and lag."""
        theta, free = rigid_start(self.flt, self.start)
        return descend("rigid", self.part, theta, free, self.box)

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
        estimate = _told(finished[0], [*plausible(finished), *others], self.box, self.fixed)
        return estimate if self._found_again(estimate, others[0], found) else None

    def _found_again(self, estimate: Estimate, best: Candidate, found: Sequence[Candidate]) -> bool:
        """Whether so many other starts lead to the estimate; half way from the nameplate is one more."""
        told = [i for i in CORE if np.isfinite(estimate.half[i])]

        def same(one: Candidate) -> bool:
            away = _distance(told_vector(one), estimate.theta)
            return bool(np.all(away[told] < np.maximum(AGAIN, estimate.half[told])))

        if not told:
            return False
        others = {one.start for one in found if one.start != best.start and same(one)}
        if len(others) == OTHERS - 1:
            theta = 0.5 * (self.begun["nameplate"] + best.theta)
            again = descend("half way", self.part, theta, best.free, self.box)
            return same(polish(again, again.flt, self.box))
        return len(others) >= OTHERS


def _finished(
    others: Sequence[Candidate], flt: ContactFilter, piece: tuple[float, float] | None, box: Box
) -> list[Candidate]:
    """Over more rows: the best two, then the best under other laws and with a third inertia; the lowest comes first."""
    found = side_by_side(lambda one: polish(one, flt, box), _apart(others)[:2])
    best = min(found, key=_cost)
    laws = [law for law in LAWS if law != flt.law]
    found += side_by_side(lambda law: replace(polish(best, replace(flt, law=law), box), start=law), laws)
    found.append(_with_piece(min(found, key=_cost), piece, box))
    return sorted(found, key=_cost)


def _with_piece(candidate: Candidate, piece: tuple[float, float] | None, box: Box) -> Candidate:
    """The candidate with a third inertia on the shaft."""
    share, compliance = piece or (SHARE, COMPLIANCE)
    theta = with_values(candidate.theta, candidate.flt, share=share, compliance=compliance)
    one = replace(
        candidate,
        start="third inertia",
        theta=theta,
        free=[*candidate.free, INDEX["share"], INDEX["compliance"]],
    )
    return polish(one, candidate.flt, box)


def plausible(found: Sequence[Candidate]) -> list[Candidate]:
    """Candidates that predict about as well as the best, which comes first."""
    found = sorted(found, key=_cost)
    return [one for one in found if alike(one, found[0])]


def _cost(one: Candidate) -> float:
    return one.cost


def _apart(found: Sequence[Candidate]) -> list[Candidate]:
    """The candidates without those that are a better one again."""
    kept: list[Candidate] = []
    for one in found:
        if all(_difference(one, other) > SAME for other in kept):
            kept.append(one)
    return kept


def _difference(one: Candidate, other: Candidate) -> float:
    """Largest of inertias, stiffness, damping and backlash; what neither has is no difference."""
    a, b = told_vector(one)[:5], told_vector(other)[:5]
    return float(np.max(np.abs(np.where(a == b, 0.0, a - b))))


def _distance(one: Array, other: Array) -> Array:
    """Between two vectors of logarithms; infinite where one has no value, so that nothing agrees on it."""
    known = np.isfinite(one) & np.isfinite(other)
    return np.where(known, np.abs(np.where(known, one, 0.0) - np.where(known, other, 0.0)), np.inf)


def _told(best: Candidate, others: Sequence[Candidate], box: Box, fixed: Collection[str]) -> Estimate:
    """Values of the best candidate; half widths from the sandwich covariance, and where plausible ones disagree."""
    run = best.flt.run(best.theta, best.free)
    gather = _gather(best)
    white = inverse_hessian(run.jacobian) * np.mean(run.weighted**2)
    coloured = sandwich(run.jacobian, run.weighted)
    covariance = gather @ np.where(np.diag(coloured).sum() > np.diag(white).sum(), coloured, white) @ gather.T
    spread = np.maximum(np.diag(gather @ white @ gather.T), np.diag(gather @ coloured @ gather.T))
    theta = told_vector(best)
    apart = np.max([_distance(told_vector(one), theta) for one in others], axis=0)
    # Innovations of e^cost times the noise: their rest has √(e^(2·cost) − 1) of it, and in all n rows √n times that.
    unexplained = np.sqrt(best.flt.rows * np.expm1(2.0 * abs(best.cost)))
    half = np.hypot(student_factor(1) * np.sqrt(spread), apart) * np.hypot(1.0, COHERENT * unexplained)
    half = np.hypot(half, _allowance(best))
    for i, name in enumerate(TOLD):
        place = INDEX[name]
        held = name != "lag" and not box.lower[place] + 1e-9 < best.theta[place] < box.upper[place] - 1e-9
        if name in fixed or held or not half[i] < np.log(NOT_EXCITED) or _other_does_as_well(best, name):
            half[i] = np.inf
    lost = {name for name, width in zip(TOLD, half, strict=True) if np.isinf(width)}
    # Neither load nor spring: the rest fits many a drive. A spring before a load that does not answer is like a gap.
    if {"inertia_load", "stiffness"} <= lost or {"inertia_load", "backlash"} <= lost:
        half[:] = np.inf
    return Estimate(theta, half, covariance, best)


def _allowance(best: Candidate) -> Array:
    """(8,) what a third inertia that the recording shows leaves open: it is one of several, and damped otherwise."""
    from ....kernels.innovations.intermediate_inertia import two_springs

    values = dict(zip(NAMES, map(float, best.flt.values(best.theta)), strict=True))
    share, motor, load = values["share"], values["inertia_motor"], values["inertia_load"]
    if not share > 0.0:
        return np.zeros(len(TOLD))
    drivetrain = Drivetrain.two_mass(**{name: values[name] for name in TOLD})  # type: ignore[arg-type]
    first, last = two_springs(motor, load, values["stiffness"], share, values["compliance"])
    inertias = np.array([(1.0 - share) * motor, share * motor, load])
    stiffness = np.array([[first, -first, 0.0], [-first, first + last, -last], [0.0, -last, last]])
    mode = np.sqrt(np.max(np.linalg.eigvals(stiffness / inertias[:, None]).real)) / (2.0 * np.pi)
    return model_allowance(TOLD, drivetrain, best.flt.dt, float(mode), sampled=True, joint=True)


def _gather(candidate: Candidate) -> Array:
    """(8, m) derivatives of the told parameters by the free ones: a delay counts as lag."""
    gather = np.zeros((len(TOLD), len(candidate.free)))
    values, dt = candidate.flt.values(candidate.theta), candidate.flt.dt
    own, total = values[INDEX["lag"]] + dt, lag(candidate) + dt
    for column, place in enumerate(candidate.free):
        if NAMES[place] == "delay":
            gather[-1, column] = dt / total
        elif NAMES[place] in TOLD:
            gather[TOLD.index(NAMES[place]), column] = own / total if NAMES[place] == "lag" else 1.0
    return gather


def _other_does_as_well(candidate: Candidate, name: str) -> bool:
    """Whether a gap, friction or damping that is off by ``NOT_EXCITED`` either way would predict about as well."""
    if name not in ("backlash", "coulomb", "viscous", "damping"):
        return False
    for factor in (NOT_EXCITED, 1.0 / NOT_EXCITED):
        theta = candidate.theta.copy()
        theta[INDEX[name]] += np.log(factor)
        if alike(replace(candidate, theta=theta, cost=candidate.flt.run(theta).cost), candidate):
            return True
    return False

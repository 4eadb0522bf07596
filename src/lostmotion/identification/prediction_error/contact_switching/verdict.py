"""What becomes of a fit: it stays, gets wider intervals, other values, or none."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ....errors import Problem
from ...statistics.levenberg_marquardt import sum_of_squares
from .. import problems as problem
from ..gain_schedule import Stage
from ..gap.absent_gap import NEEDED, without_gap
from ..identifiability import NOT_EXCITED, Told
from ..innovations import NAMES, Predictor, to_theta
from ..warnings import NEGLIGIBLE
from .estimate import APART, CORE, Estimate
from .filter import ContactFilter
from .likelihood import Candidate
from .starts.slow_motion import NAMEPLATE
from .structures.no_gap import gap_of
from .structures.rising_friction import friction_lines
from .told import told_vector

#: Values further from the nameplate than this are those of a wrong minimum, where nothing else says so (option: a value
#: ten times off under [nameplate] does no harm).
FURTHEST = 12.0

Array = NDArray[np.float64]
Outcome = tuple[Predictor, Stage, Told, list[Problem]]


@dataclass(frozen=True, eq=False)
class Fit:
    """What the observer of constant gain has found of a recording, and the nameplate."""

    predictor: Predictor
    stage: Stage
    told: Told
    start: Drivetrain

    def stays(self) -> Outcome:
        return self.predictor, self.stage, self.told, []

    def excess(self, flt: ContactFilter) -> float:
        """Innovations over what the sensor's noise makes of a speed; 0 where they are negligible."""
        predictor = self.predictor
        rest = predictor.speed_residual(self.stage.fit.residual)[predictor.settled()]
        size = float(np.sqrt(np.mean(rest**2)))
        # A speed from counts is the difference of two of them.
        noise = np.sqrt(2.0) * flt.floor / flt.dt if flt.counted else flt.floor
        return 0.0 if size < NEGLIGIBLE * float(np.std(predictor.speed)) else size / noise

    def shift(self, found: Sequence[Candidate]) -> Array:
        """How far candidates are from each identified value at most, in the logarithm; 0 with all in its interval."""
        free = self.stage.free
        away = [np.abs(told_vector(one)[free] - self.told.theta[free]) for one in found]
        largest = np.max(away, axis=0) if away else np.zeros(len(free))
        return np.where(largest > self.told.half, largest, 0.0)

    @property
    def core(self) -> NDArray[np.bool_]:
        """Which of the identified values are inertias, stiffness and backlash."""
        return np.isin(self.stage.free, CORE)

    @property
    def friction(self) -> NDArray[np.bool_]:
        """Which of the identified values are friction."""
        return np.isin(self.stage.free, [NAMES.index(name) for name in ("coulomb", "viscous")])

    def beyond_nameplate(self) -> bool:
        """Whether an inertia or the stiffness is further from the nameplate's than that is right within."""
        core = [i for i in self.stage.free if NAMES[i] in NEEDED]
        away = np.abs(self.told.theta[core] - self._nameplate()[core])
        return bool(np.any(away > np.log(NAMEPLATE)))

    def surer_than(self, half: Array) -> bool:
        """Whether it has a narrower interval of an inertia, stiffness or backlash than these half widths (8,)."""
        return bool(np.any((self.told.half < half[self.stage.free])[self.core]))

    def contradicted_by(self, found: Sequence[Candidate]) -> bool:
        """Whether inertias, stiffness or backlash of candidates are too far away for one interval."""
        shift = self.shift(found)
        return bool(np.any(np.hypot(self.told.half, shift)[(shift > 0.0) & self.core] > APART))

    def contradicts(self, found: Estimate) -> bool:
        """Whether an inertia, stiffness or backlash that another estimate tells is outside of the fit's intervals."""
        told = np.isfinite(found.half[self.stage.free])
        return bool(np.any(self.shift([found.best])[self.core & told]))

    def knows_less_than(self, found: Estimate) -> bool:
        """Whether another estimate of the same inertias, stiffness and backlash has narrower intervals of all of them.

        How friction, damping and lag make up for each other is another matter: the fit has no constant torque and no
        delay.
        """
        core = np.array(self.stage.free)[self.core]
        return not self.contradicts(found) and bool(
            np.all(found.apart_from_room[core] <= self.told.half[self.core])
        )

    def with_room_for(self, found: Sequence[Candidate], chance: Array | None) -> Outcome:
        """With intervals that contain the candidates' values as well; nothing if they are too far apart.

        Inertias, stiffness and backlash are identified up to the same width as by the other estimator. Where no
        candidate explains the recording, friction, damping and lag make up for what the model lacks: they are
        not identified. ``chance`` (8,): half widths of the likeliest candidate where that does explain it. The fit has
        friction at the load alone and no load torque, and is too sure of what these may be instead.
        """
        shift, explained = self.shift(found), chance is not None
        half = np.hypot(self.told.half, shift)
        if chance is not None:
            half = np.where(self.core, half, np.maximum(half, chance[self.stage.free]))
        wider, lost = half > self.told.half, half > np.where(self.core, APART, np.log(NOT_EXCITED))
        if not np.any(wider | lost):
            return self.stays()
        if self.contradicted_by(found):
            return self.nothing(problem.contradicted())
        if np.any(wider):
            lost |= ~self.core & (not explained)
        bound = self.told.gap_bound
        if bound is not None:
            bound = max([bound, *map(gap_of, found)])
        names = [NAMES[i] for i, doubtful in zip(self.stage.free, wider | lost, strict=True) if doubtful]
        doubt = problem.others_as_well(names)
        return replace(self, told=replace(self.told, half=half, gap_bound=bound))._without(lost, doubt)

    def nothing(self, reason: Problem) -> Outcome:
        """No value."""
        return self._without(np.ones(len(self.stage.free), dtype=bool), reason)

    def _without(self, lost: NDArray[np.bool_], reason: Problem) -> Outcome:
        """Without the identified values that are lost, which get the nameplate's."""
        stage, told = self.stage, self.told
        places = [i for i, gone in zip(stage.free, lost, strict=True) if gone]
        theta = told.theta.copy()
        theta[places] = self._nameplate()[places]
        free = [i for i in stage.free if i not in places]
        stage = _at(self.predictor, replace(stage, free=free, unexcited=(*stage.unexcited, *places)), theta)
        covariance = told.covariance[np.ix_(~lost, ~lost)]
        # A gap shows beside inertias and stiffness.
        bound = None if any(NAMES[i] in NEEDED for i in places) else told.gap_bound
        return self.predictor, stage, Told(theta, covariance, told.half[~lost], bound), [reason]

    def wrong_minimum(self, found: Estimate) -> Problem | None:
        """The problem of another estimator's inertia or stiffness that is further from the nameplate's than that may be
        wrong; None if there is none. Right values are rarely so far off, those of a wrong minimum may be anywhere."""
        nameplate = self._nameplate()
        for name in NEEDED:
            i = NAMES.index(name)
            if np.isfinite(found.half[i]) and abs(found.theta[i] - nameplate[i]) > np.log(FURTHEST):
                return problem.wrong_minimum(name, np.exp(found.theta[i]), np.exp(nameplate[i]), FURTHEST)
        return None

    def replaced_by(self, found: Estimate) -> Outcome:
        """The other estimator's values in the place of the fit's.

        Of friction, damping and lag also those that are not identified: what the motor's friction is depends on them,
        and with the nameplate's instead the model moves otherwise than the drive did.
        """
        free = [i for i in range(len(NAMES)) if np.isfinite(found.half[i])]
        if not free:
            return self.nothing(problem.contradicted())
        lines = friction_lines(found.best)
        friction = {name: lines[name] for name in ("coulomb_motor", "viscous_motor")}
        predictor = replace(self.predictor, base=self.predictor.base.with_parameters(**friction))
        # What was never to be fitted keeps the nameplate's value exactly.
        fitted = {*self.stage.free, *self.stage.unexcited}
        kept = [i for i in range(len(NAMES)) if i not in free and (i in CORE or i not in fitted)]
        theta = found.theta.copy()
        theta[kept] = self._nameplate()[kept]
        if found.gap_bound is not None:
            theta = without_gap(theta)
        lost = tuple(i for i in range(len(NAMES)) if i not in free)
        stage = _at(predictor, replace(self.stage, free=free, unexcited=lost), theta)
        told = Told(theta, found.covariance[np.ix_(free, free)], found.half[free], found.gap_bound)
        return predictor, stage, told, []

    def with_the_drive_of(self, found: Estimate) -> Outcome:
        """With inertias, stiffness, damping and backlash of another estimate of the same drive, as far as that tells
        them; friction and lag are the fit's."""
        free, told = self.stage.free, self.told
        drive = [*CORE, NAMES.index("damping")]
        taken = [k for k, i in enumerate(free) if i in drive and np.isfinite(found.half[i])]
        places = [free[k] for k in taken]
        theta, half, covariance = told.theta.copy(), told.half.copy(), told.covariance.copy()
        theta[places], half[taken] = found.theta[places], found.half[places]
        covariance[taken, :] = covariance[:, taken] = 0.0
        covariance[np.ix_(taken, taken)] = found.covariance[np.ix_(places, places)]
        stage = _at(self.predictor, self.stage, theta)
        return self.predictor, stage, Told(theta, covariance, half, told.gap_bound), []

    def _nameplate(self) -> Array:
        return to_theta([getattr(self.start, name) for name in NAMES], self.predictor.dt)


def _at(predictor: Predictor, stage: Stage, theta: Array) -> Stage:
    """The stage with other values."""
    residual = predictor.residual(theta, stage.bandwidth)
    fit = replace(stage.fit, theta=theta, residual=residual, cost=sum_of_squares(residual))
    return replace(stage, fit=fit)

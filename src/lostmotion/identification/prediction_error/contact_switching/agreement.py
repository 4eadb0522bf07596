"""What two estimators say of one recording: the observer of constant gain, and the contact-switching filter."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ....errors import InvalidInput, Problem
from ...statistics.levenberg_marquardt import sum_of_squares
from .. import problems as problem
from ..gain_schedule import Stage
from ..identifiability import NOT_EXCITED, Told
from ..innovations import NAMES, Predictor, to_theta
from ..warnings import NEGLIGIBLE
from .candidates import CORE, EXPLAINED, NOISE_ALONE, POLES, Estimate, Search
from .filter import INDEX, ContactFilter
from .fitted import intervals, within_intervals
from .likelihood import Candidate, polish
from .likelihood_ratio import alike, clearly_better
from .starts import told_vector

Array = NDArray[np.float64]


#: A rigid drive predicts so much worse than a fit whose torsion stands well above the noise, in the logarithm of the
#: innovations (calibrated on development drives 0 to 30: where it is less, another fit may predict as well).
TORSION = 0.25
#: Nothing is told where innovations are more than so many times the sensor's noise (calibrated on the virtual rigs,
#: whose four inertias make them twice as large: whatever makes them three times as large is not known well enough).
UNEXPLAINED = 3.0
#: Nor where inertias, stiffness or backlash of candidates that predict better or alike are further away than this, in
#: the logarithm (calibrated on development drives: right values agree within a tenth).
APART = 0.2


def confirmed(
    predictor: Predictor, stage: Stage, told: Told, start: Drivetrain, fixed: Collection[str]
) -> tuple[Predictor, Stage, Told, list[Problem]]:
    """The fit as it is where the contact-switching filter agrees; what that tells where it does not.

    Its cost is a likelihood. First a few torsional periods are looked at: mostly the fit stands there, and that is all.
    Otherwise it stands if no descent from any start predicts clearly better, nor a rigid drive as well. Where one does
    and finds something else, its own values are told if it explains the recording. If nothing does, the difference is
    part of the intervals, and too large a one leaves nothing.
    """
    same = predictor, stage, told, list[Problem]()
    try:
        flt = ContactFilter.of(predictor, POLES * start.pole_frequency)
    except InvalidInput:
        return same
    if not stage.free:
        return same
    search = Search.of(flt, start, predictor.drivetrain(told.theta), fixed, predictor.joint_piece)
    excess = _excess(predictor, stage, flt)
    if _stands(search.glimpse(), predictor, stage, told, excess):
        return same
    fit = within_intervals(search.part, predictor, stage, told, search.box, fixed)
    rivals = search.rivals(fit)
    fit = min(fit, search.with_all_structures(fit, intervals(stage, told, search.box)), key=_cost)
    best, rigid = min(fit, *rivals, key=_cost), search.rigid()
    nothing = predictor, *_without(predictor, stage, told, start, np.ones(len(stage.free), dtype=bool))
    if not clearly_better(best, polish(rigid, rigid.flt, search.box)):
        return *nothing, [problem.rigid()]
    better, core = [one for one in rivals if clearly_better(one, fit)], np.isin(stage.free, CORE)
    explained = abs(best.cost) < EXPLAINED
    # Where the recording is explained, whatever predicts alike may be right as well.
    others = [*better, *(one for one in rivals if explained and alike(one, best))]
    shift = _shift(others, stage, told)
    if better and np.any((shift > told.half) & core):
        estimate = search.estimate(rivals)
        if estimate is not None:
            return *_taken(predictor, stage, start, estimate), []
    if not explained and excess > UNEXPLAINED:
        return *nothing, [problem.unexplained(excess, UNEXPLAINED)]
    if not np.any(shift > told.half):
        return same
    half = np.where(shift > told.half, np.hypot(told.half, shift), told.half)
    if np.any((half > APART) & (half > told.half) & core):
        return *nothing, [problem.contradicted()]
    lost = half > np.log(NOT_EXCITED)
    names = [NAMES[i] for i, wider in zip(stage.free, half > told.half, strict=True) if wider]
    told = replace(told, half=half)
    return predictor, *_without(predictor, stage, told, start, lost), [problem.others_as_well(names)]


def _stands(search: Search, predictor: Predictor, stage: Stage, told: Told, excess: float) -> bool:
    """Whether torsion is well above the noise, and only noise is left or nothing near the fit is better."""
    fit = within_intervals(search.part, predictor, stage, told, search.box, search.fixed, NOISE_ALONE)
    if abs(fit.cost) >= EXPLAINED and excess > UNEXPLAINED:
        return False
    if search.rigid().cost < fit.cost + TORSION:
        return False
    if abs(fit.cost) < NOISE_ALONE:
        return True
    return not any(clearly_better(one, fit) for one in search.near(fit))


def _cost(one: Candidate) -> float:
    return one.cost


def _shift(found: Sequence[Candidate], stage: Stage, told: Told) -> Array:
    """How far the candidates are from each told value at most, in the logarithm."""
    away = [np.abs(told_vector(one) - told.theta)[stage.free] for one in found]
    return np.asarray(np.max(away, axis=0) if away else np.zeros(len(stage.free)))


def _without(
    predictor: Predictor, stage: Stage, told: Told, start: Drivetrain, lost: NDArray[np.bool_]
) -> tuple[Stage, Told]:
    """The fit without the free values that are lost, which get the nameplate's."""
    places, keep = [i for i, gone in zip(stage.free, lost, strict=True) if gone], ~lost
    theta = told.theta.copy()
    theta[places] = to_theta([getattr(start, name) for name in NAMES], predictor.dt)[places]
    free = [i for i in stage.free if i not in places]
    stage = _at(predictor, replace(stage, free=free, unexcited=(*stage.unexcited, *places)), theta)
    return stage, Told(theta, told.covariance[np.ix_(keep, keep)], told.half[keep])


def _at(predictor: Predictor, stage: Stage, theta: Array) -> Stage:
    residual = predictor.residual(theta, stage.bandwidth)
    return replace(
        stage, fit=replace(stage.fit, theta=theta, residual=residual, cost=sum_of_squares(residual))
    )


def _taken(
    predictor: Predictor, stage: Stage, start: Drivetrain, found: Estimate
) -> tuple[Predictor, Stage, Told]:
    """The other estimator's values in the place of the fit's."""
    friction = {
        name: float(found.best.flt.values(found.best.theta)[INDEX[name]])
        for name in ("coulomb_motor", "viscous_motor")
    }
    predictor = replace(predictor, base=predictor.base.with_parameters(**friction))
    free = [i for i in range(len(NAMES)) if np.isfinite(found.half[i])]
    theta = to_theta([getattr(start, name) for name in NAMES], predictor.dt)
    theta[free] = found.theta[free]
    lost = tuple(i for i in range(len(NAMES)) if i not in free)
    stage = _at(predictor, replace(stage, free=free, unexcited=lost), theta)
    return predictor, stage, Told(theta, found.covariance[np.ix_(free, free)], found.half[free])


def _excess(predictor: Predictor, stage: Stage, flt: ContactFilter) -> float:
    """Innovations over what the sensor's noise makes of a speed; 0 where they are negligible."""
    rest = predictor.speed_residual(stage.fit.residual)[predictor.settled()]
    size = float(np.sqrt(np.mean(rest**2)))
    # A speed from counts is the difference of two of them.
    noise = np.sqrt(2.0) * flt.floor / flt.dt if flt.counted else flt.floor
    return 0.0 if size < NEGLIGIBLE * float(np.std(predictor.speed)) else size / noise

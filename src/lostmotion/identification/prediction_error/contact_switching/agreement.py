"""What two estimators say of one recording: the observer of constant gain, and the contact-switching filter."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ....errors import InvalidInput, Problem
from ...statistics.levenberg_marquardt import sum_of_squares
from .. import problems as problem
from ..gain_schedule import Stage
from ..identifiability import Told
from ..innovations import NAMES, Predictor, to_theta
from ..warnings import NEGLIGIBLE
from .candidates import POLES, Estimate, estimate
from .filter import INDEX, ContactFilter

Array = NDArray[np.float64]


#: Without a model that explains the recording, a value is kept if both estimators agree on it within this, in the
#: logarithm, or within its interval (calibrated on development drives: right values agree within a tenth).
APART = 0.2
#: And none is, where innovations are more than so many times the sensor's noise (calibrated on the virtual rigs, whose
#: four inertias make them twice as large: whatever makes them three times as large is not known well enough)
UNEXPLAINED = 3.0


def confirmed(
    predictor: Predictor, stage: Stage, told: Told, start: Drivetrain, fixed: Collection[str]
) -> tuple[Predictor, Stage, Told, list[Problem]]:
    """The fit as it is where the contact-switching filter agrees; what that tells where it does not.

    Its cost is a likelihood, so it knows whether a model explains the recording down to the sensor's noise. Where none
    does, only that of the fit stays on which both agree.
    """
    try:
        flt = ContactFilter.of(predictor, POLES * start.pole_frequency)
    except InvalidInput:
        return predictor, stage, told, []

    def agrees(theta: Array) -> bool:
        away = np.abs(theta - told.theta)[stage.free]
        return bool(stage.free) and bool(np.all(away <= told.half))

    fitted = predictor.drivetrain(told.theta)
    found = estimate(flt, start, fitted, fixed, predictor.joint_piece, agrees)
    if found.explained:
        return (
            (predictor, stage, told, [])
            if agrees(found.theta)
            else (*_taken(predictor, stage, start, found), [])
        )
    excess = _excess(predictor, stage, flt)
    if excess > UNEXPLAINED:
        keep, problems = np.zeros(len(stage.free), dtype=bool), [problem.unexplained(excess, UNEXPLAINED)]
    else:
        keep = np.abs(found.theta - told.theta)[stage.free] <= np.maximum(told.half, APART)
        lost = [NAMES[i] for i, kept in zip(stage.free, keep, strict=True) if not kept]
        problems = [problem.disagreement(lost, APART)] if lost else []
    return predictor, *_kept(predictor, stage, told, start, keep), problems


def _kept(
    predictor: Predictor, stage: Stage, told: Told, start: Drivetrain, keep: NDArray[np.bool_]
) -> tuple[Stage, Told]:
    """The fit without the free values that are not kept, which get the nameplate's."""
    lost = [i for i, kept in zip(stage.free, keep, strict=True) if not kept]
    if not lost:
        return stage, told
    theta = told.theta.copy()
    theta[lost] = to_theta([getattr(start, name) for name in NAMES], predictor.dt)[lost]
    free = [i for i in stage.free if i not in lost]
    stage = _at(predictor, replace(stage, free=free, unexcited=(*stage.unexcited, *lost)), theta)
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

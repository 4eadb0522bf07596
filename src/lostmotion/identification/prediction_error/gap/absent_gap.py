"""A drivetrain without a gap, and up to which size one would not show: "no backlash above … rad"."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...statistics.block_covariance import Blocks, covariance, student_factor
from ..gain_schedule import Box, Stage, fit
from ..innovations import NAMES, Bandwidth, Predictor

Array = NDArray[np.float64]

PLACE = NAMES.index("backlash")
#: Without these nothing is known of a gap.
NEEDED = ("inertia_motor", "inertia_load", "stiffness")
#: The bound is wider by this where rows had to be joined: the shift by the counts is so large that it is not known
#: well (calibrated on exact recordings of two masses with 12 and 13 bit, seeds 204 to 209, to contain the truth).
JOINED = 1.5
#: First gap whose effect is looked at, over the wind-up at the torque's deviation, and rounds in which it becomes the
#: bound itself (numerics: a small gap acts in proportion to its size).
FIRST, ROUNDS = 0.01, 2


def without_gap(theta: Array) -> Array:
    """The parameter vector with a backlash of zero."""
    theta = theta.copy()
    theta[PLACE] = -np.inf
    return theta


def better_without(predictor: Predictor, stage: Stage, box: Box) -> Stage:
    """The stage, or if its gap is small and the recording is predicted better without one, that without."""
    drivetrain = predictor.drivetrain(stage.fit.theta)
    if drivetrain.backlash * drivetrain.stiffness > float(np.std(predictor.torque)):
        return stage
    free = [i for i in stage.free if i != PLACE]
    found = fit(predictor, without_gap(stage.fit.theta), free, box, stage.bandwidth)
    return replace(stage, fit=found, free=free) if found.cost < stage.fit.cost else stage


def gap_bound(predictor: Predictor, stage: Stage) -> float | None:
    """Upper end of the 95 % interval (rad) of the gap, for a fit without one.

    A small gap shifts the innovations in proportion to its size. What of this shift no other parameter can make up for
    is compared with the innovations; its covariance is that of the blocks. The larger of the bounds under the
    fit's gain and a three times higher one counts. None where a gap as large as the wind-up would not show either (a
    shaft that is never unloaded tells nothing), or where inertias or stiffness are not identified.
    """
    if not {NAMES.index(name) for name in NEEDED} <= set(stage.free):
        return None
    drivetrain = predictor.drivetrain(stage.fit.theta)
    torque, stiffness = predictor.torque, drivetrain.stiffness
    gap = FIRST * float(np.std(torque)) / stiffness
    higher = Bandwidth(3.0 * stage.bandwidth.motor, 3.0 * stage.bandwidth.load)
    for _ in range(ROUNDS):
        gap = max(_bound(predictor, stage, bandwidth, gap) for bandwidth in (stage.bandwidth, higher))
        if not gap * stiffness < float(np.max(np.abs(torque))):
            return None
    return gap


def effect_of_gap(predictor: Predictor, stage: Stage, bandwidth: Bandwidth, gap: float) -> Array:
    """(n,) change of the innovations by a gap of this size, rad."""
    theta = stage.fit.theta.copy()
    theta[PLACE] = np.log(gap)
    return predictor.residual(theta, bandwidth) - predictor.residual(stage.fit.theta, bandwidth)


def _bound(predictor: Predictor, stage: Stage, bandwidth: Bandwidth, gap: float) -> float:
    """The bound, rad, by the effect of a gap of this size."""
    residual = predictor.residual(stage.fit.theta, bandwidth)
    jacobian = predictor.jacobian(stage.fit.theta, bandwidth, stage.free, residual)
    step, deviation = shown(np.vstack([jacobian, effect_of_gap(predictor, stage, bandwidth, gap)]), residual)
    wider = JOINED if predictor.joined else 1.0
    return gap * (step + wider * student_factor(1) * deviation)


def shown(jacobian: Array, residual: Array) -> tuple[float, float]:
    """How much of the last row's effect the innovations show, at least none, and the standard deviation of that."""
    blocks = Blocks.of(jacobian, residual)
    return max(float(blocks.step[-1]), 0.0), float(np.sqrt(covariance(blocks.influences)[-1, -1]))

"""Intervals of a fit, and what the recording does not tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from .ladder import Box, Stage, fit
from .predictor import NAMES, Bandwidth, Predictor, to_theta
from .uncertainty import growth, model_allowance, sandwich, shift, student_factor, unmodelled_mode

Array = NDArray[np.float64]

#: A parameter is not excited if its 95 % interval reaches further than this factor either way (chosen). A
#: backlash is so whenever the shaft torque never reverses: then it only shifts the twist, which is not measured.
NOT_EXCITED = 3.0

#: And if a gap or a Coulomb torque that is off by ``NOT_EXCITED`` either way predicts no worse: by less than a typical
#: block's sum of squares, and by less than so many standard deviations (chosen). Then the twist has touched one side
#: only, and some gap with room for it would pass for known; or the load has stuck, and the friction that held it would.
SURE = 3.0


def half_widths(predictor: Predictor, stage: Stage) -> tuple[Array, Array]:
    """Sandwich covariance, and half widths of the 95 % intervals (see ``identify``), both in the logarithms."""
    j = predictor.jacobian(stage.fit.theta, stage.bandwidth, stage.free, stage.fit.residual)
    covariance = sandwich(j, stage.fit.residual)
    higher = Bandwidth(3.0 * stage.bandwidth.motor, 3.0 * stage.bandwidth.load)
    residual = predictor.residual(stage.fit.theta, higher)
    by_gain = shift(predictor.jacobian(stage.fit.theta, higher, stage.free, residual), residual)
    fast = np.abs(predictor.speed) > 0.5 * np.max(np.abs(predictor.speed))
    fast = np.repeat(fast, residual.size // fast.size)
    by_speed = shift(j[:, fast], stage.fit.residual[fast])
    # A nameplate value that had to be taken may be off by a factor of two, and moves the others with it.
    taken = predictor.jacobian(stage.fit.theta, stage.bandwidth, list(stage.unexcited), stage.fit.residual)
    by_nameplate = [shift(j, np.log(2.0) * moved) for moved in taken]
    statistical = student_factor(len(stage.free)) * np.sqrt(np.diag(covariance))
    names = tuple(NAMES[i] for i in stage.free)
    mode = higher_mode(predictor, stage)
    further = residual.size > predictor.speed.size
    usual = float(np.sqrt(np.mean(np.square(predictor.speed))))
    allowance = model_allowance(
        names, predictor.drivetrain(stage.fit.theta), predictor.dt, mode, further, usual
    )
    parts = [statistical, by_gain, by_speed, *by_nameplate, allowance]
    return covariance, np.sqrt(np.sum(np.square(parts), axis=0))


def higher_mode(predictor: Predictor, stage: Stage) -> float | None:
    """Frequency (Hz) of a mode that the fit leaves in the innovations, if there is one."""
    settled = predictor.settled()
    rest, speed = predictor.speed_residual(stage.fit.residual)[settled], predictor.speed[settled]
    pole = predictor.drivetrain(stage.fit.theta).pole_frequency
    return unmodelled_mode(rest, speed, predictor.dt, predictor.count_averaged, pole)


def without_unexcited(predictor: Predictor, stage: Stage, start: Drivetrain, box: Box) -> Stage:
    """Put what the recording does not tell back to the nameplate, one by one, and fit the rest again."""
    while stage.free:
        name = _unexcited(predictor, stage, box)
        if name is None:
            break
        dropped = NAMES.index(name)
        theta, free = stage.fit.theta.copy(), [i for i in stage.free if i != dropped]
        theta[dropped] = to_theta([getattr(start, n) for n in NAMES], predictor.dt)[dropped]
        found = fit(predictor, theta, free, box, stage.bandwidth)
        done = stage.iterations + found.iterations
        stage = Stage(found, stage.bandwidth, free, done, (*stage.unexcited, dropped))
    return stage


def _unexcited(predictor: Predictor, stage: Stage, box: Box) -> str | None:
    """The free parameter that the recording tells least about, if that is too little."""
    free = [NAMES[i] for i in stage.free]
    for name in ("backlash", "coulomb"):
        if name in free and _other_does_as_well(predictor, stage, name):
            return name
    _, half = half_widths(predictor, stage)
    worst = int(np.argmax(half))
    if half[worst] > np.log(NOT_EXCITED):
        return free[worst]
    # What only the box holds is not held by the recording. No lag at all is a value like any other.
    theta = stage.fit.theta
    held = (theta >= box.upper - 1e-9) | (theta <= box.lower + 1e-9)
    held[NAMES.index("lag")] = theta[-1] >= box.upper[-1] - 1e-9
    edge = [NAMES[i] for i in stage.free if held[i]]
    if edge:
        return edge[0]
    # A spring before a load that does not answer cannot be told from the gap.
    lost = {NAMES[i] for i in stage.unexcited}
    return "stiffness" if "stiffness" in free and {"inertia_load", "backlash"} <= lost else None


def _other_does_as_well(predictor: Predictor, stage: Stage, name: str) -> bool:
    """Whether a parameter that is larger or smaller by ``NOT_EXCITED`` would predict no worse."""
    for step in (np.log(NOT_EXCITED), -np.log(NOT_EXCITED)):
        theta = stage.fit.theta.copy()
        theta[NAMES.index(name)] += step
        blocks, sure = growth(predictor.residual(theta, stage.bandwidth), stage.fit.residual)
        if blocks < 1.0 and sure < SURE:
            return True
    return False

"""The width of each parameter's interval (``half_widths``), and which parameters the recording does not identify."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ..statistics.block_covariance import Blocks, covariance, excess, growth, shift, student_factor
from ..statistics.levenberg_marquardt import Fit, sum_of_squares
from .bootstrap import Replica, replicas
from .gain_schedule import Box, Stage, fit
from .gap.absent_gap import JOINED, PLACE, effect_of_gap, gap_bound, without_gap
from .innovations import NAMES, Bandwidth, Predictor, to_theta
from .model_error import model_allowance, unmodelled_mode
from .warnings import too_coarse

Array = NDArray[np.float64]

#: A parameter is not excited if its 95 % interval reaches further than this factor either way (option). A
#: backlash is so whenever the shaft torque never reverses: then it only shifts the twist, which is not measured.
NOT_EXCITED = 3.0
#: Half width, in the logarithm, beyond which the second estimator identifies no friction, damping or lag, and the slow
#: motion no total inertia (calibrated on development drives 3460 to 3580, 2026-11-27: two of six gross values are none
#: with it; on 4267 to 4440 the one gross of 94 total inertias is none).
WIDEST = 0.5

#: Innovations of more than this share of the speed's deviation may hide an eigenmode: one at so many times the
#: torsional frequency is then allowed for (calibrated on the virtual rigs 1 to 12 with 16 bit, where that at seven
#: times is no longer seen).
HIDING, HIDDEN = 0.01, 7.0

#: The allowance for it grows with the share of the innovations, twofold at this one (calibrated on the virtual rigs
#: 1 to 12 with 14 bit: noise and what the model leaves out shift the fit further together).
BLURRING = 0.03

#: Nor is a gap or a Coulomb torque excited if a value off by ``NOT_EXCITED`` either way predicts no worse: by less than
#: a typical block's sum of squares, and by less than so many standard deviations (numerics). Then the shaft was in
#: contact on one side only, or the load always stuck, and a wrong value would pass for identified.
SURE = 3.0


#: Motor torque and acceleration of opposite sign contradict the model if they are so by more than this part of the
#: nameplate's inertia (numerics: a swapped sign shows all of it, a recording without acceleration a few percent; half
#: and double decide alike on the rigs 1 and 2, ``benchmarks/calibrations.py``).
CONTRADICTION = 0.3


class _Views(NamedTuple):
    """The fit as it is, under a three times higher gain, and if only the faster half of the speeds counts."""

    own: Blocks
    gain: Blocks
    fast: Blocks
    jacobian: Array

    @classmethod
    def of(cls, predictor: Predictor, theta: Array, residual: Array, stage: Stage) -> _Views:
        j = predictor.jacobian(theta, stage.bandwidth, stage.free, residual)
        higher = Bandwidth(3.0 * stage.bandwidth.motor, 3.0 * stage.bandwidth.load)
        r = predictor.residual(theta, higher)
        # By the predicted speed: rows that are chosen by their noise would shift the fit.
        speed = np.abs(predictor.speed - predictor.speed_residual(residual))
        fast = np.repeat(speed > 0.5 * np.max(speed), residual.size // speed.size)
        gain = Blocks.of(predictor.jacobian(theta, higher, stage.free, r), r)
        return cls(Blocks.of(j, residual), gain, Blocks.of(j * fast, residual), j)


@dataclass(frozen=True, eq=False)
class Told:
    """Parameter vector (8,), and for the free ones covariance (m, m) and half widths (m,), all in the logarithms.

    And the bound of a gap that the drivetrain may do without, rad, if there is one.
    """

    theta: Array
    covariance: Array
    half: Array
    gap_bound: float | None = None


def half_widths(predictor: Predictor, stage: Stage, others: Sequence[Replica] = ()) -> tuple[Array, Array]:
    """Covariance of the logarithms, and half widths of the 95 % intervals (see ``identify``).

    With replicas, for the values ``without_shift``: what their blocks show is taken off, and their own scatter added.
    """
    own = _Views.of(predictor, stage.fit.theta, stage.fit.residual, stage)
    views = [_Views.of(o.predictor, o.fit.theta, o.fit.residual, stage) for o in others]
    # The pulls are those of a jackknife over the blocks, which has as many degrees of freedom as these less one.
    factor = student_factor(1)
    spread = covariance(_difference([v.own.influences for v in (own, *views)]))
    parts = [factor * np.sqrt(np.diag(spread))]
    for kind in ("gain", "fast"):
        pairs = [(getattr(v, kind), v.own) for v in (own, *views)]
        moved = _difference([a.step - b.step for a, b in pairs])
        parts.append(excess(moved, _difference([a.influences - b.influences for a, b in pairs]), factor))
    # A nameplate value that had to be taken may be off by a factor of two, and moves the others with it.
    taken = predictor.jacobian(stage.fit.theta, stage.bandwidth, list(stage.unexcited), stage.fit.residual)
    parts += [shift(own.jacobian, np.log(2.0) * moved) for moved in taken]
    # A nameplate of zero may be off by any factor: the others may be what they were with a value that fitted.
    parts.append(stage.unknown[stage.free])
    # The replicas are made with the torque as it is used: joined rows are not like the recorded ones.
    parts.append(_allowance(predictor, stage, bool(others) and not predictor.joined))
    wider = JOINED if predictor.joined else 1.0
    return spread, wider * np.sqrt(np.sum(np.square(parts), axis=0))


def without_shift(stage: Stage, others: Sequence[Replica]) -> Array:
    """Parameter vector of the fit without what the replicas' fits are off by, on average."""
    theta, free = stage.fit.theta.copy(), stage.free
    if others:
        theta[free] -= np.mean([other.fit.theta[free] - theta[free] for other in others], axis=0)
    return theta


def _difference(values: list[Array]) -> Array:
    """The first without the mean of the others."""
    return values[0] - np.mean(values[1:], axis=0) if len(values) > 1 else values[0]


def _allowance(predictor: Predictor, stage: Stage, sampled: bool) -> Array:
    names = tuple(NAMES[i] for i in stage.free)
    further = stage.fit.residual.size > predictor.speed.size
    usual = float(np.sqrt(np.mean(np.square(predictor.speed))))
    drivetrain = predictor.drivetrain(stage.fit.theta)
    mode = higher_mode(predictor, stage)
    rest = predictor.speed_residual(stage.fit.residual)[predictor.settled()]
    share = float(np.std(rest) / np.std(predictor.speed))
    if mode is None and share > HIDING:
        mode = HIDDEN * drivetrain.pole_frequency / np.sqrt(1.0 + share / BLURRING)
    return model_allowance(
        names, drivetrain, predictor.dt, mode, further, usual, sampled, predictor.joint_piece is not None
    )


def higher_mode(predictor: Predictor, stage: Stage) -> float | None:
    """Frequency (Hz) of a mode that the fit leaves in the innovations, if there is one."""
    settled = predictor.settled()
    rest, speed = predictor.speed_residual(stage.fit.residual)[settled], predictor.speed[settled]
    pole = predictor.drivetrain(stage.fit.theta).pole_frequency
    return unmodelled_mode(rest, speed, predictor.dt, predictor.speed_from_counts, pole)


def without_unexcited(predictor: Predictor, stage: Stage, start: Drivetrain, box: Box) -> Stage:
    """Set parameters that are not identified back to the nameplate, one by one, and fit the rest again."""
    while stage.free:
        name = _unexcited(predictor, stage, box)
        if name is None:
            break
        stage = _put_back(predictor, stage, start, box, name)
    return stage


def told(predictor: Predictor, stage: Stage, start: Drivetrain, box: Box, total: float) -> tuple[Stage, Told]:
    """The stage without the parameters that recording or replicas do not identify; values and intervals of the rest.

    ``total`` is the inertia that the recording shows at low frequency, kg m2: clearly negative, nothing is identified.
    """
    rest, speed = predictor.speed_residual(stage.fit.residual), predictor.speed
    if total < -CONTRADICTION * start.inertia_total or too_coarse(
        float(np.sqrt(np.mean(rest[predictor.settled()] ** 2))), float(np.std(speed))
    ):
        stage = _nothing(predictor, stage, start)
    while True:
        stage = without_unexcited(predictor, stage, start, box)
        others = replicas(predictor, stage, box) if stage.free else []
        covariance, half = half_widths(predictor, stage, others)
        if not np.any(half > np.log(NOT_EXCITED)):
            return stage, Told(without_shift(stage, others), covariance, half, _gap_bound(predictor, stage))
        stage = _put_back(predictor, stage, start, box, NAMES[stage.free[int(np.argmax(half))]])


def _nothing(predictor: Predictor, stage: Stage, start: Drivetrain) -> Stage:
    """All that is free put back to the nameplate."""
    theta = stage.fit.theta.copy()
    theta[stage.free] = to_theta([getattr(start, n) for n in NAMES], predictor.dt)[stage.free]
    residual = predictor.residual(theta, stage.bandwidth)
    nameplate = replace(stage.fit, theta=theta, residual=residual, cost=sum_of_squares(residual))
    return replace(stage, fit=nameplate, free=[], unexcited=(*stage.unexcited, *stage.free))


def _put_back(predictor: Predictor, stage: Stage, start: Drivetrain, box: Box, name: str) -> Stage:
    dropped = NAMES.index(name)
    theta, free = stage.fit.theta.copy(), [i for i in stage.free if i != dropped]
    absent = _without_gap(predictor, stage, start, box, free) if name == "backlash" else None
    unknown = stage.unknown.copy()
    if absent is not None:
        found, moved = absent
        unknown[free] = np.hypot(unknown[free], moved)
    else:
        theta[dropped] = to_theta([getattr(start, n) for n in NAMES], predictor.dt)[dropped]
        found = fit(predictor, theta, free, box, stage.bandwidth)
        if getattr(start, name) == 0.0:
            unknown[free] = np.hypot(unknown[free], found.theta[free] - stage.fit.theta[free])
    done = stage.iterations + found.iterations
    return Stage(found, stage.bandwidth, free, done, (*stage.unexcited, dropped), unknown)


def _without_gap(
    predictor: Predictor, stage: Stage, start: Drivetrain, box: Box, free: list[int]
) -> tuple[Fit, Array] | None:
    """The fit without a gap, and how far the largest gap that would not show moves it.

    None if a gap predicts better, or if that of the nameplate would not show either.
    """
    found = fit(predictor, without_gap(stage.fit.theta), free, box, stage.bandwidth)
    if growth(found.residual, stage.fit.residual)[1] > SURE:
        return None
    bare = replace(stage, fit=found, free=free)
    bound = gap_bound(predictor, bare)
    if bound is None or 0.0 < start.backlash < bound:
        return None
    jacobian = predictor.jacobian(found.theta, stage.bandwidth, free, found.residual)
    return found, shift(jacobian, effect_of_gap(predictor, bare, stage.bandwidth, bound))


def _gap_bound(predictor: Predictor, stage: Stage) -> float | None:
    """Of a gap that is not in the model although it was free."""
    absent = PLACE in stage.unexcited and not np.isfinite(stage.fit.theta[PLACE])
    return gap_bound(predictor, stage) if absent and stage.free else None


def _unexcited(predictor: Predictor, stage: Stage, box: Box) -> str | None:
    """The free parameter that is identified worst, if it is not identified."""
    free = [NAMES[i] for i in stage.free]
    for name in ("backlash", "coulomb"):
        if name in free and _other_does_as_well(predictor, stage, name):
            return name
    _, half = half_widths(predictor, stage)
    worst = int(np.argmax(half))
    if half[worst] > np.log(NOT_EXCITED):
        return free[worst]
    # A value at its search bound is not identified. A lag of zero is a value like any other.
    theta = stage.fit.theta
    held = (theta >= box.upper - 1e-9) | (theta <= box.lower + 1e-9)
    held[NAMES.index("lag")] = theta[-1] >= box.upper[-1] - 1e-9
    edge = [NAMES[i] for i in stage.free if held[i]]
    if edge:
        return edge[0]
    # If neither load inertia nor gap is identified, the stiffness cannot be distinguished from the gap.
    lost = {NAMES[i] for i in stage.unexcited}
    if "stiffness" in free and {"inertia_load", "backlash"} <= lost:
        return "stiffness"
    # Friction of the load shows only by how it slows the load or twists the shaft.
    return "coulomb" if "coulomb" in free and {"inertia_load", "stiffness"} <= lost else None


def _other_does_as_well(predictor: Predictor, stage: Stage, name: str) -> bool:
    """Whether a parameter that is larger or smaller by ``NOT_EXCITED`` would predict no worse."""
    for step in (np.log(NOT_EXCITED), -np.log(NOT_EXCITED)):
        theta = stage.fit.theta.copy()
        theta[NAMES.index(name)] += step
        blocks, sure = growth(predictor.residual(theta, stage.bandwidth), stage.fit.residual)
        if blocks < 1.0 and sure < SURE:
            return True
    return False

"""Identify a two-mass drivetrain with backlash from motor torque and motor speed, by prediction error."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from . import findings, starts
from .gauss_newton import Fit, minimise
from .predictor import NAMES, Bandwidth, Predictor, from_theta, to_theta
from .result import Identification, Prediction, Source
from .uncertainty import model_allowance, sandwich, shift, student_factor, unmodelled_mode

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]

#: Observer gains, from high to low, as fractions of the angular frequencies of pole (motor) and zero
#: (load). Chosen on finer plants: the first makes the cost smooth, the last ones let what the model leaves
#: out (a mode at seven times the pole) bias the fit least.
LADDER = (Bandwidth(2.5, 0.38), Bandwidth(0.85, 0.11), Bandwidth(0.45, 0.06))

#: A lower gain is kept only while the innovations grow by no more than this factor (chosen). Above it the
#: observer no longer follows, because of disturbances or of a rugged cost.
LARGEST_GROWTH = 1.5

#: A parameter is not excited if its 95 % interval reaches further than this factor either way (chosen).
NOT_EXCITED = 3.0

#: The shaft torque must change its sign at least so often for the backlash: once each way.
FEWEST_REVERSALS = 2

#: Fewest rows and shortest time that are accepted (chosen: five periods of a 10 Hz mode).
MIN_ROWS, MIN_TIME = 2000, 0.5

#: Time before the innovations count, s (chosen: a few time constants of the observer).
SETTLING = 0.1

#: Steps at most for each gain of the ladder (chosen; three are usual).
ITERATIONS = 15

#: A lag is fitted down to this fraction of a sample (chosen: far below what can be told from none).
SMALLEST_LAG = 0.05

#: No parameter leaves its start by more than this factor (chosen).
FARTHEST = 20.0


@dataclass(frozen=True, eq=False)
class _Stage:
    """A fit over the whole recording with the gain at which it was made."""

    fit: Fit
    bandwidth: Bandwidth
    free: list[int]
    iterations: int
    unexcited: tuple[int, ...] = ()


def identify(
    recording: Recording,
    *,
    start: Drivetrain,
    fixed: Collection[str] = (),
    count_averaged: bool | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Find the two-mass drivetrain whose observer predicts the motor speed best.

    The innovations of ``observers.kalman`` (motor torque and motor speed alone) are minimised over the
    logarithms of the parameters. A grid over motor inertia, stiffness and backlash around the nameplate
    finds the valley; the observer's gain then goes from high to low.

    A half width of a 95 % interval is, in the logarithm, √(s² + g² + f² + n² + a²). s is the sandwich
    standard error times Student's factor. The rest stands for what the model leaves out: g is how far a
    three times higher gain would move the estimate; f is how far it moves if only the faster half of the
    speed range counts (friction may be no straight line); n is how far it moves if the nameplate values
    that had to be taken for what is not excited are off by a factor of two; a allows for the sampling, and
    for a mode above the torsional one that stands out in the innovations (``uncertainty.model_allowance``).

    Parameters
    ----------
    recording : Recording
        ``torque_motor`` (Nm, held from row to row) and ``speed_motor`` (rad/s); nothing else is looked at.
    start : Drivetrain
        Two masses, nameplate values, right within a factor of two. A zero for backlash, damping, coulomb,
        viscous or lag means "not known".
    fixed : collection of str
        Names out of ``predictor.NAMES`` that keep their nameplate value.
    count_averaged : bool, optional
        Whether the speed is an encoder's count difference, so a mean over the sample before. Default: what
        ``recording.meta["count_averaged"]`` says, else found from the quantisation of the signal.
    progress : callable, optional
        Called with a fraction from 0 to 1 and a text.

    Returns
    -------
    Identification

    Raises
    ------
    InvalidInput
        If a signal is missing, not finite or constant, the raster is not uniform within 5 %, the recording is
        too short, or a name in ``fixed`` is unknown.

    Notes
    -----
    ``lag`` stands for the sum of current lag, filters and delay, which cannot be told apart.
    Friction of the motor stays as in ``start``. The torque is taken as free of scale error, the speed as
    free of bias: both would show as inertia and as asymmetric friction.
    """
    say = progress or (lambda fraction, text: None)
    predictor = _predictor(recording, start, fixed, count_averaged)
    free = [i for i, name in enumerate(NAMES) if name not in fixed]
    say(0.0, "searching the start")
    theta, total = starts.complete(start, predictor, fixed)
    theta = starts.search(theta, total, predictor, start, fixed, _bandwidth(start, LADDER[0]))
    stage = _descend(predictor, theta, free, say)
    say(0.8, "computing the intervals")
    stage = _without_unexcited(predictor, stage, start)
    found = _result(recording, predictor, stage, start, fixed)
    say(1.0, "identified")
    return found


def _predictor(
    recording: Recording, start: Drivetrain, fixed: Collection[str], count_averaged: bool | None
) -> Predictor:
    unknown = sorted(set(fixed) - set(NAMES))
    if unknown:
        raise InvalidInput("identify.fixed", f"{unknown}", f"names out of {NAMES}", "Check the names.")
    if set(fixed) >= set(NAMES):
        raise InvalidInput("identify.fixed", "every parameter", "at least one to identify", "Free one.")
    if len(start.inertias) != 2:
        raise InvalidInput(
            "identify.start", f"{len(start.inertias)} inertias", "two masses", "Use Drivetrain.two_mass."
        )
    findings.check_recording(recording, MIN_ROWS, MIN_TIME)
    speed = np.ascontiguousarray(recording["speed_motor"])
    if count_averaged is None:
        count_averaged = bool(recording.meta.get("count_averaged", findings.is_quantised(speed)))
    skip = min(int(SETTLING / recording.dt), speed.size // 10)
    base = start.with_contact("viscoelastic")
    return Predictor(
        np.ascontiguousarray(recording["torque_motor"]), speed, recording.dt, count_averaged, base, skip
    )


def _bandwidth(drivetrain: Drivetrain, rung: Bandwidth) -> Bandwidth:
    return Bandwidth(
        rung.motor * 2.0 * np.pi * drivetrain.pole_frequency,
        rung.load * 2.0 * np.pi * drivetrain.zero_frequency,
    )


def _fit(predictor: Predictor, theta: Array, free: list[int], bandwidth: Bandwidth) -> Fit:
    lower, upper = theta - np.log(FARTHEST), theta + np.log(FARTHEST)
    if NAMES.index("lag") in free:
        lower[-1] = np.log((1.0 + SMALLEST_LAG) * predictor.dt)
        theta = np.maximum(theta, lower)
    return minimise(
        lambda t: predictor.residual(t, bandwidth),
        lambda t, r: predictor.jacobian(t, bandwidth, free, r),
        theta, free, lower, upper, ITERATIONS,
    )  # fmt: skip


def _descend(predictor: Predictor, theta: Array, free: list[int], say: Progress) -> _Stage:
    """Fit with ever lower gain, each from the result of the one before."""
    stages: list[_Stage] = []
    for number, rung in enumerate(LADDER):
        say(0.2 + 0.2 * number, f"fitting, gain {number + 1} of {len(LADDER)}")
        bandwidth = _bandwidth(predictor.drivetrain(theta), rung)
        fit = _fit(predictor, theta, free, bandwidth)
        if stages and not fit.cost < LARGEST_GROWTH**2 * stages[-1].fit.cost:
            break
        done = fit.iterations + (stages[-1].iterations if stages else 0)
        stages.append(_Stage(fit, bandwidth, free, done))
        theta = fit.theta
    return stages[-1]


def _half_widths(predictor: Predictor, stage: _Stage) -> tuple[Array, Array]:
    """Sandwich covariance, and half widths of the 95 % intervals without the allowance for the model."""
    j = predictor.jacobian(stage.fit.theta, stage.bandwidth, stage.free, stage.fit.residual)
    covariance = sandwich(j, stage.fit.residual)
    higher = Bandwidth(3.0 * stage.bandwidth.motor, 3.0 * stage.bandwidth.load)
    residual = predictor.residual(stage.fit.theta, higher)
    by_gain = shift(predictor.jacobian(stage.fit.theta, higher, stage.free, residual), residual)
    fast = np.abs(predictor.speed) > 0.5 * np.max(np.abs(predictor.speed))
    by_speed = shift(j[:, fast], stage.fit.residual[fast])
    # A nameplate value that had to be taken may be off by a factor of two, and moves the others with it.
    taken = predictor.jacobian(stage.fit.theta, stage.bandwidth, list(stage.unexcited), stage.fit.residual)
    by_nameplate = [shift(j, np.log(2.0) * moved) for moved in taken]
    statistical = student_factor(len(stage.free)) * np.sqrt(np.diag(covariance))
    return covariance, np.sqrt(np.sum(np.square([statistical, by_gain, by_speed, *by_nameplate]), axis=0))


def _without_unexcited(predictor: Predictor, stage: _Stage, start: Drivetrain) -> _Stage:
    """Put what the recording does not tell back to the nameplate, one by one, and fit the rest again."""
    while stage.free:
        name = _unexcited(predictor, stage)
        if name is None:
            break
        dropped = NAMES.index(name)
        theta, free = stage.fit.theta.copy(), [i for i in stage.free if i != dropped]
        theta[dropped] = to_theta([getattr(start, n) for n in NAMES], predictor.dt)[dropped]
        fit = _fit(predictor, theta, free, stage.bandwidth)
        done = stage.iterations + fit.iterations
        stage = _Stage(fit, stage.bandwidth, free, done, (*stage.unexcited, dropped))
    return stage


def _unexcited(predictor: Predictor, stage: _Stage) -> str | None:
    """The free parameter that the recording tells least about, if that is too little."""
    if 4 in stage.free and predictor.reversals(stage.fit.theta, stage.bandwidth) < FEWEST_REVERSALS:
        return "backlash"
    _, half = _half_widths(predictor, stage)
    worst = int(np.argmax(half))
    return NAMES[stage.free[worst]] if half[worst] > np.log(NOT_EXCITED) else None


def _result(
    recording: Recording, predictor: Predictor, stage: _Stage, start: Drivetrain, fixed: Collection[str]
) -> Identification:
    theta, residual, names = stage.fit.theta, stage.fit.residual, tuple(NAMES[i] for i in stage.free)
    drivetrain = predictor.drivetrain(theta)
    rest, speed = residual[predictor.skip :], predictor.speed[predictor.skip :]
    mode = unmodelled_mode(rest, speed, predictor.dt, predictor.count_averaged, drivetrain.pole_frequency)
    covariance, half = _half_widths(predictor, stage)
    half = np.hypot(half, model_allowance(names, drivetrain, predictor.dt, mode))
    full = np.zeros(theta.size)
    full[stage.free] = half
    low, high = (from_theta(theta + sign * full, predictor.dt) for sign in (-1.0, 1.0))
    rms = float(np.sqrt(np.mean(rest**2)))
    prediction = Prediction(
        time=recording.time,
        speed_motor=predictor.speed - residual,
        residual=residual,
        rms=rms,
        fit=1.0 - rms / float(np.std(predictor.speed)),
        iterations=stage.iterations,
        unmodelled_frequency=mode,
    )
    sources: dict[str, Source] = {
        name: "identified" if name in names else "nameplate" if name in fixed else "not excited"
        for name in NAMES
    }
    return Identification(
        drivetrain=drivetrain,
        values={n: None if sources[n] == "not excited" else float(getattr(drivetrain, n)) for n in NAMES},
        intervals={NAMES[i]: (float(low[i]), float(high[i])) for i in stage.free},
        sources=sources,
        problems=findings.warnings(
            start, drivetrain, sources, names, covariance, prediction, stage.fit.converged
        ),
        prediction=prediction,
        names=names,
        covariance=covariance,
    )

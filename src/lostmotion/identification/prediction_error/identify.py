"""Identify a two-mass drivetrain with backlash from motor torque and motor speed, by prediction error."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput, Problem
from ...recording import Recording
from ..statistics.estimates import Interval, Source
from . import initial_values, warnings
from . import problems as problem
from .channel_innovations import ChannelPredictor
from .contact_switching.agreement import confirmed
from .contact_switching.likelihood import Candidate
from .contact_switching.structures.in_words import structure_of
from .gain_schedule import LADDER, Box, Progress, Stage, bandwidth_for, descent, fit
from .gap.absent_gap import better_without
from .identifiability import Told, higher_mode, told
from .innovations import NAMES, Predictor, from_theta
from .intermediate_inertia import with_joint_piece
from .noise_levels import refine
from .result import Identification, Prediction, Structure
from .segments import Pieces, join
from .slow_motion.total_inertia import of_slow_motion, total_inertia

Array = NDArray[np.float64]

#: Signals that may be measured beside the motor speed.
FURTHER = ("speed_load", "twist", "torque_shaft", "angle_motor")

#: Part of the progress that the fit alone makes (numerics: a search after it may take ten times as long).
FIT_ALONE = 0.3
#: Contact laws that the observer can have.
CONTACTS = ("viscoelastic", "dead_zone")

#: Fewest rows and shortest time that are accepted (numerics: 200 periods of six samples are 1200 rows; five
#: periods of an eigenmode at 10 Hz).
MIN_ROWS, MIN_TIME = 1000, 0.5

#: Time before the innovations count, s (numerics), and after a gap: there the observer knows less than at rest, and its
#: slowest pole is at about 14 1/s.
SETTLING, SETTLING_LATER = 0.1, 0.4


@checks_arguments
def identify(
    recording: Recording | Sequence[Recording],
    *,
    start: Drivetrain,
    fixed: Collection[str] = (),
    measured: Sequence[str] = ("speed_motor",),
    load_torque: bool = False,
    contact: str = "viscoelastic",
    joint_piece: bool = True,
    second_estimator: bool = True,
    speed_from_counts: bool | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Find the two-mass drivetrain whose observer predicts the motor speed, and what else is measured, best.

    The innovations of ``observers.kalman`` (motor torque and motor speed alone) are minimised over the
    logarithms of the parameters. A grid over motor inertia, stiffness and backlash around the nameplate
    finds the valley; the observer's gain then goes from high to low. Where it predicts clearly better, the model gets
    an intermediate inertia: a part of the motor's inertia that sits on the shaft before the gap (``joint_piece``).
    Stiffness and damping then are those of the two masses with the same torsional mode.

    A half width of a 95 % interval is, in the logarithm, √(s² + g² + f² + n² + u² + a²):

    - s: Student's factor times the standard error, from the blocks of the recording.
    - g: how far a three times higher gain would move the estimate, beyond its 95 % noise level.
    - f: likewise, if only the faster half of the speed range counts (friction may be no straight line).
    - n: how far it moves if the nameplate's values of what is not excited are off by a factor of two.
    - u: how far it moved when a parameter was left out whose nameplate is zero.
    - a: for a mode above the torsional one that stands out in the innovations, or that noise may hide
      (``model_error.model_allowance``).

    The bias by sampling and counts is found by simulating what was identified, and subtracted (``bootstrap``); without
    such simulations a bound of it is in a. Where counts are coarse, rows are joined; where the innovations still leave
    too little of the speed, nothing is identified (``warnings``).

    The total inertia is identified where nothing else is, from the motion far below the zero
    (``slow_motion.total_inertia``).

    Motor torque and motor speed alone are then given to a second estimator, a Kalman filter that follows gap and
    sticking, with friction at both ends, a delay and an unknown load torque (``contact_switching.search``). The fit
    stands if nothing predicts clearly better or knows the same values better. Else what does is reported, if it stands
    out from whatever else predicts as well; if not, the intervals contain both, or nothing is identified
    (``contact_switching.agreement``).

    Parameters
    ----------
    recording : Recording, or several of one sample time
        ``torque_motor`` (Nm, held from row to row) and the ``measured`` signals; nothing else is looked at. Rows with
        a NaN and missing rows are gaps: the observer starts anew after each.
    start : Drivetrain
        Two masses, nameplate values, right within a factor of two. A zero for backlash, damping, coulomb,
        viscous or lag means "not known".
    fixed : collection of str
        Names out of ``innovations.NAMES`` that keep their nameplate value.
    measured : sequence of str
        ``speed_motor`` (rad/s), and any of ``FURTHER``: speed_load (rad/s), twist, angle_motor (rad), torque_shaft
        (Nm), free of bias. Each counts by its own noise, which is estimated.
    load_torque : bool
        Whether an unknown, slowly changing torque acts on the load. How slowly is estimated.
    contact : {"viscoelastic", "dead_zone"}
        Contact law of the observer; see ``compare_contacts``.
    joint_piece : bool
        Whether an intermediate inertia is tried; not with further channels, a load torque or the dead-zone law.
    second_estimator : bool
        Whether the contact-switching filter judges the fit; not with further channels, a load torque or the dead-zone
        law. On drives unlike the virtual rig it finds most values that are wrong and yet called identified.
    speed_from_counts : bool, optional
        Whether the speeds are an encoder's count difference, so a mean over the sample before. Default: what
        ``recording.meta["speed_from_counts"]`` says, else found from the quantisation of the signal.
    progress : callable, optional
        Called with a fraction from 0 to 1 and a text.

    Returns
    -------
    Identification

    Raises
    ------
    InvalidInput
        If a signal is missing, not finite or constant, the raster is not uniform within 5 %, the recording is
        too short or takes too much memory, or a name in ``fixed`` or ``measured`` or a contact law is unknown.

    Notes
    -----
    ``lag`` stands for the sum of current lag, filters and delay, which cannot be separated.
    Friction of the motor stays as in ``start``. The torque is taken as free of scale error, the speed as
    free of bias: both would show as inertia and as asymmetric friction.
    """
    progress = say = progress or (lambda fraction, text: None)
    recordings = [recording] if isinstance(recording, Recording) else list(recording)
    _check(start, fixed, measured, contact)
    for one in recordings:
        warnings.check_recording(one, ("torque_motor", *measured))
    pieces = join(recordings, ("torque_motor", *measured))
    wide = load_torque or contact != "viscoelastic" or len(measured) > 1
    warnings.check_length(pieces.time.size, pieces.dt, MIN_ROWS, MIN_TIME)
    warnings.check_size(pieces.time.size, len(measured))
    predictor = _predictor(pieces, recordings[0], start, speed_from_counts)
    slow = of_slow_motion(predictor, start.zero_frequency)
    coarse: list[Problem] = []
    if predictor.speed_from_counts and not wide:
        rows, coarse = warnings.rows_to_join(predictor.speed, pieces.dt, start.pole_frequency)
        if rows > 1:
            pieces = pieces.joined(rows)
            predictor = replace(_predictor(pieces, recordings[0], start, True), joined=True)
    free = [i for i, name in enumerate(NAMES) if name not in fixed]
    judged = second_estimator and not wide
    say = _between(0.0, FIT_ALONE, say) if judged else say
    say(0.0, "searching the start")
    theta, total = initial_values.complete(start, predictor, fixed)
    box = Box.around(theta, predictor.dt)
    theta, second = initial_values.search(
        theta, total, predictor, start, fixed, bandwidth_for(start, LADDER[0])
    )
    found = None
    if joint_piece and not wide:
        upper = descent(predictor, theta, free, box, say, fit, gains=2)
        # The search takes longer than all the rest: only where innovations ask for it, and not for a gap that is not
        # there.
        if higher_mode(predictor, better_without(predictor, upper[-1], box)) is not None:
            found = with_joint_piece(predictor, upper, box)
        theta = upper[0].fit.theta
    predictor, stage = found or (predictor, descent(predictor, theta, free, box, _not_before(0.5, say))[-1])
    ambiguous = _second_minimum(predictor, second, stage, box)
    if wide:
        say(0.7, "fitting all channels")
        channels = _channel_predictor(predictor, pieces, recordings[0], measured, contact, speed_from_counts)
        predictor, stage = refine(channels, theta, stage, box, load_torque)
    say(0.8, "computing the intervals")
    stage, values = told(predictor, stage, start, box, total)
    doubts: list[Problem] = []
    compared: list[Candidate] = []
    if judged:
        predictor, stage, values, doubts = confirmed(
            predictor, stage, values, start, fixed, slow, compared, _between(FIT_ALONE, 1.0, progress)
        )
    structure = structure_of(predictor, stage, compared, judged, load_torque)
    inertia = total_inertia(slow, stage, values)
    result = _result(pieces, predictor, stage, values, start, fixed, total, structure, inertia)
    if not result.names and warnings.is_too_coarse(result.prediction):
        doubts = []  # one reason why nothing is identified is enough: no model explains what is lost in the counts
    if compared:
        ambiguous = []  # all minima were compared by their likelihood: the interval has those that predict as well
    result = replace(result, problems=(*result.problems, *doubts, *ambiguous, *coarse))
    progress(1.0, "identified")
    return result


def _not_before(first: float, say: Progress) -> Progress:
    """Progress that never goes back before ``first``."""
    return lambda fraction, text: say(max(first, fraction), text)


def _between(first: float, last: float, say: Progress) -> Progress:
    """Progress of one part of the work."""
    return lambda fraction, text: say(first + (last - first) * fraction, text)


def _check(start: Drivetrain, fixed: Collection[str], measured: Sequence[str], contact: str) -> None:
    known = ("speed_motor", *FURTHER)
    if "speed_motor" not in measured or not set(measured) <= set(known) or len(set(measured)) < len(measured):
        raise InvalidInput(
            "identify.measured",
            f"{tuple(measured)}",
            f"speed_motor, and any of {FURTHER}",
            "Check the names.",
        )
    if contact not in CONTACTS:
        raise InvalidInput("identify.contact", repr(contact), f"one of {CONTACTS}", "Check the name.")
    unknown = sorted(set(fixed) - set(NAMES))
    if unknown:
        raise InvalidInput("identify.fixed", f"{unknown}", f"names out of {NAMES}", "Check the names.")
    if set(fixed) >= set(NAMES):
        raise InvalidInput("identify.fixed", "every parameter", "at least one to identify", "Free one.")
    if len(start.inertias) != 2:
        raise InvalidInput(
            "identify.start", f"{len(start.inertias)} inertias", "two masses", "Use Drivetrain.two_mass."
        )


def _predictor(
    pieces: Pieces, recording: Recording, start: Drivetrain, speed_from_counts: bool | None
) -> Predictor:
    speed = pieces.signals["speed_motor"]
    if speed_from_counts is None:
        speed_from_counts = bool(
            recording.meta.get("speed_from_counts", warnings.count_step(speed) is not None)
        )
    skip = min(int(SETTLING / pieces.dt), pieces.bounds[1] // 10)
    later = int(SETTLING_LATER / pieces.dt)
    base = start.with_contact("viscoelastic")
    torque = pieces.signals["torque_motor"]
    return Predictor(torque, speed, pieces.dt, speed_from_counts, base, skip, pieces.bounds, later)


def _second_minimum(predictor: Predictor, second: Array | None, stage: Stage, box: Box) -> list[Problem]:
    """A warning if the search's second minimum is one of the whole recording too."""
    if second is None:
        return []
    other = fit(predictor, second, stage.free, box, stage.bandwidth)
    if initial_values.rival([stage.fit, other]) is None:
        return []
    values = dict(zip(NAMES, from_theta(other.theta, predictor.dt), strict=True))
    return [problem.second_minimum(predictor.drivetrain(stage.fit.theta), values)]


def _channel_predictor(
    predictor: Predictor,
    pieces: Pieces,
    recording: Recording,
    measured: Sequence[str],
    contact: str,
    speed_from_counts: bool | None,
) -> ChannelPredictor:
    channels = {name: pieces.signals[name] for name in measured if name != "speed_motor"}
    averaged = ["speed_motor"] if predictor.speed_from_counts else []
    if "speed_load" in channels:
        stated = recording.meta.get("speed_from_counts") if speed_from_counts is None else speed_from_counts
        if warnings.count_step(channels["speed_load"]) is not None if stated is None else stated:
            averaged.append("speed_load")
    return ChannelPredictor(
        predictor.torque, predictor.speed, predictor.dt, predictor.speed_from_counts,
        predictor.base.with_contact(contact), predictor.skip, predictor.bounds, predictor.skip_later,
        channels=channels, averaged=tuple(averaged),
    )  # fmt: skip


def _result(
    pieces: Pieces,
    predictor: Predictor,
    stage: Stage,
    values: Told,
    start: Drivetrain,
    fixed: Collection[str],
    total: float,
    structure: Structure,
    inertia: tuple[float, Interval] | None,
) -> Identification:
    residual, names = stage.fit.residual, tuple(NAMES[i] for i in stage.free)
    theta = values.theta
    drivetrain = predictor.drivetrain(theta)
    full = np.zeros(theta.size)
    full[stage.free] = values.half
    low, high = (from_theta(theta + sign * full, predictor.dt) for sign in (-1.0, 1.0))
    own = start.inertia_total
    innovation = predictor.speed_residual(residual)
    rms = float(np.sqrt(np.mean(innovation[predictor.settled()] ** 2)))
    prediction = Prediction(
        time=pieces.time,
        speed_motor=predictor.speed - innovation,
        residual=innovation,
        rms=rms,
        fit=1.0 - rms / float(np.std(predictor.speed)),
        iterations=stage.iterations,
        unmodelled_frequency=higher_mode(predictor, stage),
        levels=predictor.noise_levels(residual),
        joint_piece=predictor.joint_piece,
    )
    sources: dict[str, Source] = {
        name: "identified" if name in names else "nameplate" if name in fixed else "not excited"
        for name in NAMES
    }
    found = {n: None if sources[n] == "not excited" else float(getattr(drivetrain, n)) for n in NAMES}
    bounds = {} if values.gap_bound is None else {"backlash": (0.0, values.gap_bound)}
    if inertia is not None:
        bounds["inertia_total"] = inertia[1]
    return Identification(
        drivetrain=drivetrain,
        values=found | {"inertia_total": None if inertia is None else inertia[0]},
        intervals={NAMES[i]: (float(low[i]), float(high[i])) for i in stage.free} | bounds,
        sources=sources,
        problems=(
            *pieces.problems(),
            *warnings.warnings(
                start,
                drivetrain,
                total,
                sources,
                names,
                values.covariance,
                prediction,
                stage.fit.converged,
                pieces.dt,
                values.gap_bound,
            ),
            *([] if inertia is not None else [problem.not_excited("inertia_total", own, own)]),
        ),
        prediction=prediction,
        structure=structure,
        names=names,
        covariance=values.covariance,
        speed_from_counts=predictor.speed_from_counts,
    )

"""What the best candidate tells: values, and intervals from its likelihood and from what predicts about as well."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...statistics.block_covariance import sandwich, student_factor
from ..gap.absent_gap import NEEDED
from ..identifiability import NOT_EXCITED, WIDEST
from ..innovations import NAMES as TOLD
from .likelihood import Box, Candidate, inverse_hessian
from .likelihood_ratio import alike
from .parameter_vector import FRICTIONS, INDEX
from .structures.division import room_for_division
from .structures.no_gap import gap_bound, without_gap
from .told import lag, lag_as_held, room_for_rest, told_slopes, told_vector

Array = NDArray[np.float64]

#: What the model leaves unexplained is no noise: it may push a value one way in all rows. This part of it does so
#: (calibrated on calibration drives 10400 to 10529, 2026-11-24, see docs/benchmarks/zoo.md; with 0.01 half widths are
#: 7.0 instead of 7.4 times the error on 119 development drives of 3460 to 3899, 95.7 instead of 96.2 % hold).
COHERENT = 0.02
#: Places of inertias, stiffness and backlash: what the others hang on.
CORE = [TOLD.index(name) for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]
#: Places of inertias and stiffness: the drive but for its gap.
WITHOUT_GAP = [TOLD.index(name) for name in NEEDED]
#: An inertia, stiffness or backlash with a larger half width is not identified, nor is one where candidates that
#: predict better or alike are further away (calibrated on development drives 3940 to 4266, 2026-11-27: of the 29 up to
#: 0.5 nine are grossly wrong, of the 393 below three).
APART = 0.2
#: Excess of the innovations over the sensor's noise, as a logarithm, up to which the model explains the recording
#: (calibrated on development drives 0 to 49: below, errors are as large as the intervals say, above they are not).
EXPLAINED = 0.25
#: The same up to which a recording shows no gap (calibrated on development drives 1850 to 2049 and 5716 to 5872,
#: 2026-11-29: 14 right bounds of a gap come with 0.04 at most, false ones with 0.045 and 0.23).
SHOWS_NO_GAP = 0.04
#: Half width by chance of inertias, stiffness and backlash below which the rest of the search leads from a candidate
#: that explains the recording to the best one (calibrated on development drives 1400 to 1899, 2026-11-24: 17 of 19 such
#: descents were off by 1.3 % at most, two backlashes by 7 and 52 %, which came out right; of 6 with up to 0.2 three
#: were off by 10 to 39 %).
SHARP = 0.05
#: A count over the standard deviation of its rounding (physics: uniform within it).
COUNT = np.sqrt(12.0)
#: A parameter whose change shows less than this part of what the one shown best does is not shown (numerics: rounding).
NO_INFORMATION = 1e-9


@dataclass(frozen=True, eq=False)
class Estimate:
    """Parameters of ``innovations.NAMES``: vector (8,), half widths (8,; infinite: not identified), best candidate;
    the bound of a gap (rad), if it does without one; and the part (8,) of the half widths that is room for
    inertias that the model lacks."""

    theta: Array
    half: Array
    covariance: Array
    best: Candidate
    gap_bound: float | None = None
    room: Array | float = 0.0

    @property
    def apart_from_room(self) -> Array:
        """(8,) half widths without that room: what compares with those of another estimator of the same drive."""
        return np.sqrt(np.maximum(self.half**2 - np.asarray(self.room) ** 2, 0.0))


def distance(one: Candidate, other: Candidate) -> Array:
    """(8,) of the told parameters' logarithms: 0 where neither has a value, infinite where one has none; of lags with
    the torque between rows the same way."""
    a, b = told_vector(one), told_vector(other)
    if one.flt.ramp is not other.flt.ramp:
        a[-1], b[-1] = lag_as_held(one), lag_as_held(other)
    with np.errstate(invalid="ignore"):
        return np.where(a == b, 0.0, np.abs(a - b))


def scatter(candidate: Candidate) -> tuple[Array, Array]:
    """Covariance (8, 8) of the told parameters by chance, and their standard errors (8,); infinite: not excited."""
    run, seen = candidate.run, shown(candidate)
    if not np.any(seen):
        return np.zeros((len(TOLD), len(TOLD))), np.full(len(TOLD), np.inf)
    parts = told_slopes(candidate)
    jacobian, gather = run.jacobian[seen], parts[:, seen]
    silent = parts.any(axis=1) & ~gather.any(axis=1)
    white = inverse_hessian(jacobian) * np.mean(run.weighted**2)
    coloured = sandwich(jacobian, run.weighted)
    larger = coloured if np.diag(coloured).sum() > np.diag(white).sum() else white
    variances = [np.diag(gather @ each @ gather.T) for each in (white, coloured)]
    return gather @ larger @ gather.T, np.where(silent, np.inf, np.sqrt(np.maximum(*variances)))


def shown(candidate: Candidate) -> NDArray[np.bool_]:
    """(m,) which of the free parameters the recording shows."""
    size = np.linalg.norm(candidate.run.jacobian, axis=1)
    # Numbers that grow without bound tell nothing, nor does a standstill.
    if not np.all(np.isfinite(candidate.run.jacobian)):
        return np.zeros(size.size, dtype=np.bool_)
    return np.asarray(size > NO_INFORMATION * np.max(size, initial=0.0))


def by_chance(candidate: Candidate, error: Array) -> Array:
    """(8,) half widths of what the innovations scatter, from the standard errors (8,)."""
    return np.asarray(student_factor(1) * error * beyond_chance(candidate))


def sharp(candidate: Candidate) -> bool:
    """Whether it explains the recording with inertias, stiffness and backlash that chance leaves no room: then no
    minimum far from it has to be looked for."""
    if not abs(candidate.cost) < EXPLAINED:
        return False
    _, error = scatter(candidate)
    return bool(np.all(by_chance(candidate, error)[CORE] < SHARP))


def told(
    best: Candidate,
    others: Sequence[Candidate],
    disagreement: Array,
    room: Array,
    box: Box,
    fixed: Collection[str],
) -> Estimate:
    """Values of the best candidate; half widths from its standard errors and from where others disagree.

    ``others`` predict as well, so that any of them may be right; ``disagreement`` (8,) is that of other fits of the
    same model, see ``intervals.refits``; ``room`` (8,) is for inertias that the model does not have, see
    ``intervals.further_inertias``.
    """
    covariance, error = scatter(best)
    theta = told_vector(best)
    apart = np.max([distance(one, best) for one in others], axis=0)
    half = by_chance(best, error)
    half = np.sqrt(half**2 + apart**2 + disagreement**2 + room**2 + room_for_rest(best) ** 2)
    # A smooth torque that is held acts as one that goes straight from row to row, half a row later: the lag is one or
    # the other, each by chance.
    if best.flt.ramp:
        half[-1] += np.log(lag(best) + best.flt.dt) - lag_as_held(best)
    half = _narrow(half, fixed)
    # Friction, damping and lag make up for what the model lacks.
    if abs(best.cost) >= EXPLAINED:
        half[[i for i in range(len(TOLD)) if i not in CORE]] = np.inf
    for i, name in enumerate(TOLD):
        place = INDEX[name]
        held = name != "lag" and not box.lower[place] + 1e-9 < best.theta[place] < box.upper[place] - 1e-9
        absent = not np.isfinite(theta[i])
        if name in fixed or held or absent or np.isinf(half[i]) or _other_does_as_well(best, name):
            half[i] = np.inf
    half = _narrow(half, fixed)
    found = Estimate(theta, half, covariance, best, room=room)
    if "backlash" in fixed or not np.any(np.isfinite(half)):
        return found
    return _where_no_gap_shows(found, others, box, fixed)


def _narrow(half: Array, fixed: Collection[str]) -> Array:
    """Half widths; infinite where noise, rows and places that predict as well scatter so far that it is no interval.

    Of load, spring and gap one alone may be missing: the rest fits many a drive. (A spring before a load that does not
    answer is like a gap; of the six values beside a motor inertia alone on calibration drives one was grossly wrong.)
    """
    half = np.where(half > WIDEST, np.inf, half)
    half[CORE] = np.where(half[CORE] > APART, np.inf, half[CORE])
    lost = {name for name, width in zip(TOLD, half, strict=True) if np.isinf(width)} - set(fixed)
    if len(lost & {"inertia_load", "stiffness", "backlash"}) > 1:
        half[:] = np.inf
    return half


def _where_no_gap_shows(
    found: Estimate, others: Sequence[Candidate], box: Box, fixed: Collection[str]
) -> Estimate:
    """Without a backlash and with the bound of one where the recording is explained; where there is none, or a gap of
    any size does about as well as the own one, with room for a gap elsewhere.
    """
    half, backlash = found.half.copy(), TOLD.index("backlash")
    # What is not explained may hide a gap.
    explained = -EXPLAINED < found.best.cost < SHOWS_NO_GAP
    bounded = explained and np.all(np.isfinite(half[WITHOUT_GAP]))
    if np.isfinite(half[backlash]) and not bounded:
        return found
    gapless = without_gap(found.best, box)
    if gapless is None and not _other_does_as_well(found.best, "backlash"):
        return found  # the gap is in this shaft, whatever its size
    if gapless is not None and bounded:
        half[backlash] = np.inf
        bound = gap_bound(gapless, beyond_chance(gapless), box, others)
        if bound is not None:
            return replace(found, half=half, best=gapless, gap_bound=bound)
    # Where the recording is not explained, any further inertia of the model may be the joint.
    room = room_for_division(found.best, APART if abs(found.best.cost) < EXPLAINED else np.inf)
    return replace(found, half=_narrow(np.hypot(half, room), fixed), room=np.hypot(found.room, room))


def beyond_chance(best: Candidate) -> float:
    """By how much what is not explained widens what chance makes of an interval."""
    # Innovations of e^cost times the noise: their rest has √(e^(2·cost) − 1) of it, and in all n rows √n times that.
    unexplained = np.sqrt(best.flt.counting.size * np.expm1(2.0 * abs(best.cost)))
    return float(np.hypot(1.0, COHERENT * unexplained))


def _other_does_as_well(candidate: Candidate, name: str) -> bool:
    """Whether a gap, friction or damping that is off by ``NOT_EXCITED`` either way would predict about as well, or no
    friction; of a gap below a count nothing shows but that its impacts are uncertain."""
    if name not in ("backlash", "coulomb", "viscous", "damping"):
        return False
    flt, value = candidate.flt, candidate.values[name]
    if name == "backlash" and value < COUNT * flt.position_noise:
        return True
    for factor in (NOT_EXCITED, 1.0 / NOT_EXCITED, *((0.0,) if name in FRICTIONS else ())):
        theta = flt.changed(candidate.theta, **{name: factor * value})
        if alike(replace(candidate, theta=theta, cost=flt.run(theta).cost), candidate):
            return True
    return False

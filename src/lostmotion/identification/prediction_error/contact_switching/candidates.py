"""Whole descents of the contact-switching filter from several starts and in several structures, judged by one cost."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ...statistics.block_covariance import sandwich, student_factor
from ..innovations import NAMES as TOLD
from .filter import INDEX, LAWS, NAMES, ContactFilter, pole_of
from .likelihood import Box, Candidate, descend, inverse_hessian, polish
from .moves import other_minima
from .starts import free_places, lag, start_values, starts, told_vector, with_values

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

#: A candidate is plausible if its cost is within the first number of the best, and within this part of what the best is
#: above the sensor's noise: where no candidate reaches that, none can be told from another by so little (calibrated on
#: development drives 0 to 5: what differed by less was within the intervals).
ALIKE, ALIKE_SHARE = 0.003, 0.2
#: Excess of the innovations over the sensor's noise, as a logarithm, up to which the model explains the recording
#: (calibrated on development drives 0 to 49: below, errors are as large as the intervals say, above they are not).
EXPLAINED = 0.25
#: What the model leaves unexplained is no noise, and shifts the values: half widths grow by this times the cost
#: (calibrated, see docs/identification.md).
INFLATION = 10.0
#: And up to which it leaves nothing but the noise (numerics: 5 % above it).
NOISE_ALONE = 0.05
#: A cost from which on no other minima are looked for (numerics: moves gain less).
HOPELESS = 1.0

#: A value is told if a cost this factor away would be clearly higher (numerics, as ``identifiability.NOT_EXCITED``).
NOT_EXCITED = 3.0


@dataclass(frozen=True, eq=False)
class Estimate:
    """Parameters of ``innovations.NAMES``: vector (8,), half widths (8,; infinite if not identified), best candidate.

    Where no candidate explains the recording, half widths are infinite, and friction is that of both ends together.
    """

    theta: Array
    half: Array
    covariance: Array
    best: Candidate
    explained: bool


def estimate(
    flt: ContactFilter,
    start: Drivetrain,
    fitted: Drivetrain,
    fixed: Collection[str],
    piece: tuple[float, float] | None,
    agrees: Callable[[Array], bool],
) -> Estimate:
    """What the contact-switching filter tells.

    Parameters
    ----------
    flt : ContactFilter
        Over the whole recording.
    start, fitted : Drivetrain
        Nameplate; what the observer of constant gain has found.
    fixed : names that keep the nameplate's value
    piece : share and compliance of a third inertia, if that was found.
    agrees : callable
        Whether a vector (8,) is within the intervals of what was found: no more is looked for if that leaves nothing
        but the sensor's noise.
    """
    begun = starts(flt, start, fitted, fixed)
    box = Box.around(flt, begun["nameplate"], FAR).including(begun["fitted"], FAR)
    rows = int(np.clip(PERIODS / (flt.dt * pole_of(begun["nameplate"])), FEWEST, MOST))
    part, free = flt.liveliest(rows), free_places(start, fixed)
    found = [descend("fitted", part, begun.pop("fitted"), free, box, FITTED_LEVEL)]
    if found[0].cost < NOISE_ALONE and agrees(told_vector(found[0])):
        return Estimate(told_vector(found[0]), np.full(len(TOLD), np.inf), np.empty((0, 0)), found[0], True)
    found += [descend(name, part, one, free, box) for name, one in begun.items()]
    if min(one.cost for one in found) < HOPELESS:
        found += other_minima(min(found, key=lambda one: one.cost), box)
    others = plausible(found)
    if others[0].cost < 2.0 * EXPLAINED:
        found = _finished(others, flt.liveliest(ROWS), piece, box)
        if found[0].cost < EXPLAINED:
            return _told(found[0], [*plausible(found), *others], box, fixed)
    # An unknown load torque makes up for much that the model lacks, and the load inertia with it.
    near = with_values(flt.theta(start_values(flt, fitted, start, fixed)), flt, torque_rate=0.0)
    second = descend("fitted", part, near, free, box, FITTED_LEVEL)
    theta = told_vector(second)
    for name in ("coulomb", "viscous"):
        at_motor = second.theta[INDEX[f"{name}_motor"]]
        theta[TOLD.index(name)] = np.logaddexp(theta[TOLD.index(name)], at_motor)
    return Estimate(theta, np.full(theta.size, np.inf), np.empty((0, 0)), second, False)


def _finished(
    others: Sequence[Candidate], flt: ContactFilter, piece: tuple[float, float] | None, box: Box
) -> list[Candidate]:
    """Over more rows: the best two, then the best under other laws and with a third inertia; the lowest comes first."""
    found = [polish(one, flt, box) for one in _apart(others)[:2]]
    best = min(found, key=lambda one: one.cost)
    found += [
        replace(polish(best, replace(flt, law=law), box, 5), start=law) for law in LAWS if law != flt.law
    ]
    found.append(_with_piece(min(found, key=lambda one: one.cost), piece, box))
    return sorted(found, key=lambda one: one.cost)


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
    found = sorted(found, key=lambda one: one.cost)
    within = ALIKE + ALIKE_SHARE * max(found[0].cost, 0.0)
    return [one for one in found if one.cost <= found[0].cost + within]


def _apart(found: Sequence[Candidate]) -> list[Candidate]:
    """The candidates without those that are a better one again."""
    kept: list[Candidate] = []
    for one in found:
        if all(np.max(np.abs(told_vector(one) - told_vector(other))[:5]) > SAME for other in kept):
            kept.append(one)
    return kept


def _told(best: Candidate, others: Sequence[Candidate], box: Box, fixed: Collection[str]) -> Estimate:
    """Values of the best candidate; half widths from the sandwich covariance, and where plausible ones disagree."""
    run = best.flt.run(best.theta, best.free)
    gather = _gather(best)
    white = inverse_hessian(run.jacobian) * np.mean(run.weighted**2)
    coloured = sandwich(run.jacobian, run.weighted)
    covariance = gather @ np.where(np.diag(coloured).sum() > np.diag(white).sum(), coloured, white) @ gather.T
    spread = np.maximum(np.diag(gather @ white @ gather.T), np.diag(gather @ coloured @ gather.T))
    theta = told_vector(best)
    apart = np.max([np.abs(told_vector(one) - theta) for one in others], axis=0)
    half = np.hypot(student_factor(1) * np.sqrt(spread), apart) * (1.0 + INFLATION * max(best.cost, 0.0))
    for i, name in enumerate(TOLD):
        place = INDEX[name]
        held = name != "lag" and not box.lower[place] + 1e-9 < best.theta[place] < box.upper[place] - 1e-9
        if name in fixed or held or not half[i] < np.log(NOT_EXCITED) or _other_does_as_well(best, name):
            half[i] = np.inf
    lost = {name for name, width in zip(TOLD, half, strict=True) if np.isinf(width)}
    # Neither load nor spring: the rest fits many a drive. A spring before a load that does not answer is like a gap.
    if {"inertia_load", "stiffness"} <= lost or {"inertia_load", "backlash"} <= lost:
        half[:] = np.inf
    return Estimate(theta, half, covariance, best, True)


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
    most = candidate.cost + ALIKE + ALIKE_SHARE * max(candidate.cost, 0.0)
    for factor in (NOT_EXCITED, 1.0 / NOT_EXCITED):
        theta = candidate.theta.copy()
        theta[INDEX[name]] += np.log(factor)
        if candidate.flt.run(theta).cost < most:
            return True
    return False

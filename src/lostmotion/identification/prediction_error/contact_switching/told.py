"""What a candidate tells of a drivetrain: the vector of ``innovations.NAMES`` and its derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..innovations import NAMES as TOLD
from .likelihood import Candidate
from .parameter_vector import INDEX
from .structures.rising_friction import friction_lines

Array = NDArray[np.float64]

#: Step of differences in θ (numerics: far above rounding, far below any interval).
STEP = 1e-6
#: Speed over its standard deviation up to which an end is at rest for certain (numerics: rounding).
RESTS = 1e-6


def lag(candidate: Candidate) -> float:
    """Lag and delay together, s."""
    return max(_lag(candidate), 0.0)


def lag_as_held(candidate: Candidate) -> float:
    """The entry of ``told_vector`` for the lag, with a torque that is held from row to row: one that goes straight acts
    half a row earlier."""
    rows = 0.5 if candidate.flt.ramp else 1.0
    return float(np.log(lag(candidate) + rows * candidate.flt.dt))


def _lag(candidate: Candidate) -> float:
    """The same below zero as well: a measured torque may be ahead of that which acts."""
    values = candidate.values
    return values["lag"] + values["delay"]


def told_vector(candidate: Candidate, speeds: tuple[Array, Array] | None = None) -> Array:
    """Parameter vector in the order of ``innovations.NAMES``; ``speeds`` for ``friction_lines``."""
    theta = candidate.theta[[INDEX[name] for name in TOLD]]
    lines = friction_lines(candidate, speeds)
    with np.errstate(divide="ignore"):
        for name in ("coulomb", "viscous"):
            theta[TOLD.index(name)] = np.log(lines[name])
    theta[-1] = np.log(lag(candidate) + candidate.flt.dt)
    return theta


def told_slopes(candidate: Candidate) -> Array:
    """(8, m) derivatives of that vector by the free parameters; zero where it is not finite."""
    base, columns = told_vector(candidate), []
    # How the speeds change is far less than how the curve does.
    speeds = candidate.speeds if candidate.rises else None
    for place in candidate.free:
        theta = candidate.theta.copy()
        theta[place] += STEP
        other = replace(candidate, theta=theta)
        with np.errstate(invalid="ignore"):
            columns.append((told_vector(other, speeds) - base) / STEP)
        # Its chance is that of the sum, also where that is below zero.
        columns[-1][-1] = (_lag(other) - _lag(candidate)) / STEP / (lag(candidate) + candidate.flt.dt)
    return np.nan_to_num(np.array(columns).T, nan=0.0, posinf=0.0, neginf=0.0)


def room_for_rest(candidate: Candidate) -> Array:
    """(8,) how far the line that stands for a rising friction depends on which of the slow rows are no rest."""
    if not candidate.rises:
        return np.zeros(len(TOLD))
    with np.errstate(invalid="ignore"):
        other = np.abs(told_vector(candidate, candidate.speeds_above(RESTS)) - told_vector(candidate))
    return np.asarray(np.nan_to_num(other))

"""What a candidate tells of a drivetrain: the vector of ``innovations.NAMES`` and its derivatives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..innovations import NAMES as TOLD
from .filter import INDEX
from .likelihood import Candidate
from .structures.rising_friction import friction_lines

Array = NDArray[np.float64]

#: Step of differences in θ (numerics: far above rounding, far below any interval).
STEP = 1e-6


def lag(candidate: Candidate) -> float:
    """Lag and delay together, s."""
    return max(_lag(candidate), 0.0)


def _lag(candidate: Candidate) -> float:
    """The same below zero as well: a measured torque may be ahead of that which acts."""
    values = candidate.values
    return values["lag"] + values["delay"]


def told_vector(candidate: Candidate) -> Array:
    """Parameter vector in the order of ``innovations.NAMES``."""
    theta = candidate.theta[[INDEX[name] for name in TOLD]]
    lines = friction_lines(candidate)
    with np.errstate(divide="ignore"):
        for name in ("coulomb", "viscous"):
            theta[TOLD.index(name)] = np.log(lines[name])
    theta[-1] = np.log(lag(candidate) + candidate.flt.dt)
    return theta


def told_slopes(candidate: Candidate) -> Array:
    """(8, m) derivatives of that vector by the free parameters; zero where it is not finite."""
    base, columns = told_vector(candidate), []
    for place in candidate.free:
        theta = candidate.theta.copy()
        theta[place] += STEP
        other = replace(candidate, theta=theta)
        with np.errstate(invalid="ignore"):
            columns.append((told_vector(other) - base) / STEP)
        # Its chance is that of the sum, also where that is below zero.
        columns[-1][-1] = (_lag(other) - _lag(candidate)) / STEP / (lag(candidate) + candidate.flt.dt)
    return np.nan_to_num(np.array(columns).T, nan=0.0, posinf=0.0, neginf=0.0)

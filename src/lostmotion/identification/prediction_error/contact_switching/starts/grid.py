"""A coarse grid of starts in the drive's own dimensionless numbers."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .....drivetrain import Drivetrain
from ...innovations import NAMES as TOLD
from ..filter import ContactFilter
from ..likelihood import Candidate
from ..parameter_vector import INDEX
from .from_drivetrain import free_places, frictions, unknown, usual_damping

Array = NDArray[np.float64]

#: Load over motor inertia (numerics: beyond what drives have).
RATIOS = tuple(np.geomspace(1.0 / 40.0, 40.0, 8))
#: Torsional frequency over the nameplate's (numerics: a nameplate is off by three either way).
POLES = tuple(np.geomspace(0.25, 4.0, 5))
#: Backlash over the wind-up at the torque's standard deviation (numerics: none to a wide gap).
BACKLASHES = (0.02, 0.3, 2.0, 10.0)


def points(
    flt: ContactFilter, start: Drivetrain, fixed: Collection[str], like: Sequence[Array]
) -> Iterator[Array]:
    """The grid; lag and delay are those of each of some starts in turn, what is fixed keeps the nameplate's value."""
    total, pole = flt.inertia[0], 2.0 * np.pi * start.pole_frequency
    known = fixed_values(start, fixed) | frictions(flt, start, fixed)
    lags = [INDEX["lag"], INDEX["delay"]]
    for (i, ratio), (j, factor), (k, gap) in product(*map(enumerate, (RATIOS, POLES, BACKLASHES))):
        motor, load = total / (1.0 + ratio), total * ratio / (1.0 + ratio)
        theta = flt.theta(point(flt, motor, load, factor * pole, gap) | known)
        theta[lags] = like[(i + j + k) % len(like)][lags]
        yield theta


def fixed_values(start: Drivetrain, fixed: Collection[str]) -> dict[str, float]:
    """Nameplate values of what is fixed."""
    return {name: float(getattr(start, name)) for name in fixed if name in TOLD}


def point(flt: ContactFilter, motor: float, load: float, omega: float, gap: float) -> dict[str, float]:
    """Values of a start with these inertias (kg m²), torsional frequency (rad/s) and backlash over the wind-up."""
    stiffness = omega**2 * motor * load / (motor + load)
    return {
        "inertia_motor": motor, "inertia_load": load, "stiffness": stiffness,
        "damping": usual_damping(stiffness, omega), "backlash": gap * flt.torque_deviation / stiffness,
    } | unknown(flt, omega)  # fmt: skip


def candidates(
    flt: ContactFilter, start: Drivetrain, fixed: Collection[str], like: Sequence[Array]
) -> list[Candidate]:
    """The grid's points over some rows; their cost is not known."""
    free = free_places(start, fixed)
    return [Candidate("grid", theta, np.inf, flt, free) for theta in points(flt, start, fixed, like)]

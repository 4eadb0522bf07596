"""A coarse grid of starts with a gap and a third inertia, on what two inertias have shown."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from itertools import product

import numpy as np

from .....drivetrain import Drivetrain
from ..filter import ContactFilter
from ..likelihood import Candidate
from ..starts.from_drivetrain import free_places
from ..starts.grid import fixed_values, point
from .shaft_inertias import THIRD, Place, placed

#: Torsional frequency over the nameplate's (numerics: a nameplate is off by three either way), and backlash over the
#: wind-up at the torque's standard deviation (numerics: a gap that shows).
POLES, BACKLASHES = tuple(np.geomspace(0.3, 3.2, 6)), (0.3, 2.0, 10.0)
#: A light inertia on a stiff or a soft shaft, or a heavy one, before the gap or behind it (numerics: from one of them a
#: descent that comes down through the noise levels leads to the drive's).
PARTS = ((0.03, 0.3), (0.03, 0.9), (0.3, 0.6))
THIRDS = tuple(Place(*part, behind=behind) for part in PARTS for behind in (False, True))
#: Load over motor inertia at least (numerics: as little as shows).
LEAST_LOAD = 0.02


def candidates(
    two: Candidate, rows: ContactFilter, start: Drivetrain, fixed: Collection[str]
) -> list[Candidate]:
    """The grid's points over some rows; their cost is not known. What is fixed keeps the nameplate's value.

    Motor inertia, friction and lag are those of a fit with two inertias, which tells them even where its gap is wrong;
    the load's inertia is the rest of what the slow motion tells.
    """
    free = sorted({*two.free, *free_places(start, fixed), *THIRD})
    motor, pole = two.values["inertia_motor"], 2.0 * np.pi * start.pole_frequency
    load = max(rows.inertia[0] - motor, LEAST_LOAD * motor)
    flt, known, begun = two.over(rows), fixed_values(start, fixed), []
    for factor, gap, third in product(POLES, BACKLASHES, THIRDS):
        values = point(flt, motor, load, factor * pole, gap) | known
        one = replace(two, theta=flt.changed(two.theta, **values))
        at, theta = placed(one, third, rows)
        begun.append(Candidate("grid of three", theta, np.inf, at, free))
    return begun

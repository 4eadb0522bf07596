"""A coarse grid of starts: what the slow motion leaves open, in the drive's own dimensionless numbers."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ..innovations import NAMES as TOLD
from .filter import ContactFilter
from .likelihood import side_by_side
from .slow_motion import SlowMotion
from .starts import DAMPING_RATIO, LAG, RATE, TORQUE_RATE

Array = NDArray[np.float64]

#: Load over motor inertia (numerics: beyond what drives have).
RATIOS = tuple(np.geomspace(1.0 / 40.0, 40.0, 8))
#: Torsional frequency over the nameplate's (numerics: a nameplate is off by three either way).
POLES = tuple(np.geomspace(0.25, 4.0, 9))
#: Backlash over the wind-up at the torque's standard deviation (numerics: none to a wide gap).
BACKLASHES = (0.02, 0.3, 2.0, 10.0)
#: The motor's share of the friction (numerics: nearly none and nearly all).
AT_MOTOR = (0.1, 0.9)
#: Halvings of a sample at most: a grid need not place an impact finely (numerics).
HALVINGS = 4


@dataclass(frozen=True)
class Point:
    """Place in the grid, and the parameter vector there."""

    place: tuple[int, ...]
    theta: Array


def points(flt: ContactFilter, start: Drivetrain, fixed: Collection[str]) -> Iterator[Point]:
    """The grid; what is fixed keeps the nameplate's value."""
    slow = SlowMotion.of(flt, start)
    torque, total, pole = flt.torque_deviation, slow.inertia, 2.0 * np.pi * start.pole_frequency
    known = {name: float(getattr(start, name)) for name in fixed if name in TOLD}
    if start.coulomb_motor > 0.0 or start.viscous_motor > 0.0:
        known |= {"coulomb_motor": start.coulomb_motor, "viscous_motor": start.viscous_motor}
    else:
        known |= {f"{name}_motor": 0.0 for name in ("coulomb", "viscous") if name in fixed}
    axes = [list(enumerate(axis)) for axis in (RATIOS, POLES, BACKLASHES, AT_MOTOR)]
    for (i, ratio), (j, factor), (k, gap), (m, share) in product(*axes):
        omega = factor * pole
        motor, load = total / (1.0 + ratio), total * ratio / (1.0 + ratio)
        stiffness = omega**2 * motor * load / total
        values = {
            "inertia_motor": motor, "inertia_load": load, "stiffness": stiffness,
            "damping": 2.0 * DAMPING_RATIO * stiffness / omega, "backlash": gap * torque / stiffness,
            "coulomb": (1.0 - share) * slow.coulomb, "viscous": (1.0 - share) * slow.viscous,
            "coulomb_motor": share * slow.coulomb, "viscous_motor": share * slow.viscous,
            "load_torque": slow.load_torque, "lag": LAG * flt.dt, "delay": LAG * flt.dt,
            "motor_rate": RATE * omega, "load_rate": RATE * omega, "torque_rate": TORQUE_RATE * torque,
        } | known  # fmt: skip
        yield Point((i, j, k, m), flt.theta(values))


def best(flt: ContactFilter, start: Drivetrain, fixed: Collection[str]) -> list[Array]:
    """The best point of each plane of the grid, the best of all first.

    Of the points that predict best, many are one mistake: all inertia in the motor, say. The best for each inertia
    ratio, each frequency, each backlash lets the others have their descent too.
    """
    coarse, grid = replace(flt, halvings=min(flt.halvings, HALVINGS)), list(points(flt, start, fixed))
    costs = side_by_side(lambda point: coarse.run(point.theta).cost, grid)
    kept: list[Array] = []
    seen: set[tuple[int, int]] = set()
    for number in np.argsort(costs, kind="stable"):
        planes = set(enumerate(grid[number].place))
        if not planes <= seen:
            kept.append(grid[number].theta)
            seen |= planes
    return kept

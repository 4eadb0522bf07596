"""What the observer of constant gain has found, as the contact-switching filter sees it."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from ..gain_schedule import Stage
from ..identifiability import Told
from ..innovations import NAMES as TOLD
from ..innovations import Predictor, from_theta
from .filter import ContactFilter
from .likelihood import Box, Candidate, fitted_rates, minimise
from .parameter_vector import INDEX
from .starts.from_drivetrain import unknown

Array = NDArray[np.float64]

#: Gauss–Newton steps before and after the rates are fitted (numerics: two or three reach the edge of an interval).
STEPS = 6


def intervals(flt: ContactFilter, stage: Stage, told: Told, box: Box) -> Box:
    """The box, no wider than the fit's intervals where it tells a value."""
    places, half = [INDEX[TOLD[i]] for i in stage.free], np.zeros(len(TOLD))
    half[stage.free] = told.half

    def end(bounds: Array, theta: Array) -> Array:
        values = dict(zip(TOLD, map(float, from_theta(theta, flt.dt)), strict=True))
        bounds[places] = flt.theta(values)[places]
        return bounds

    return Box(end(box.lower.copy(), told.theta - half), end(box.upper.copy(), told.theta + half))


def within_intervals(
    flt: ContactFilter,
    predictor: Predictor,
    stage: Stage,
    told: Told,
    box: Box,
    fixed: Collection[str],
    enough: float = 0.0,
) -> Candidate:
    """The likeliest values within the intervals of the fit, in its own structure.

    What the fit does not tell is free within its bounds. The filter's noise is fitted first: a drive that is known
    exactly needs little. No better values are looked for once the cost is below ``enough``.
    """
    drivetrain, names = predictor.drivetrain(told.theta), ("coulomb_motor", "viscous_motor")
    values = {name: float(getattr(drivetrain, name)) for name in (*TOLD, *names)}
    values |= unknown(flt, 2.0 * np.pi * drivetrain.pole_frequency)
    free = [INDEX[name] for name in TOLD if name not in fixed and (values[name] > 0.0 or name == "lag")]
    if predictor.joint_piece is not None:
        values |= dict(zip(("share", "compliance"), predictor.joint_piece, strict=True)) | {"loss": 1.0}
        free += [INDEX["share"], INDEX["compliance"]]
    theta, box = flt.theta(values), intervals(flt, stage, told, box)
    # Unknown torques stand for nothing else: with their rates as they come, a right fit looks poor.
    for _ in range(2):
        theta = fitted_rates(flt, theta)
        cost = flt.run(theta).cost
        if abs(cost) < enough:
            break
        theta, cost = minimise(flt, theta, sorted(free), box, STEPS)
    return Candidate("fit", theta, cost, flt, sorted(free))

"""Friction that rises towards rest (Stribeck): where descents with it start, and the line that stands for it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..likelihood import FITTED_LEVEL, Box, Candidate, descend
from ..parameter_vector import INDEX

Array = NDArray[np.float64]

#: Rise over the Coulomb level, and speeds over which it fades, over the speed's standard deviation, with which descents
#: start (numerics).
RISE, FADES = 0.2, (0.03, 0.3)
#: Steps of a descent at each noise level (numerics).
STEPS = 4
#: The two ends of the drivetrain, as their parameters' names end.
ENDS = ("", "_motor")


def may_rise(candidate: Candidate) -> bool:
    """Whether a friction is free whose rise is not fitted."""
    return not candidate.rises and any(INDEX[f"coulomb{end}"] in candidate.free for end in ENDS)


def with_rising_friction(candidate: Candidate, fade: float, box: Box) -> Candidate:
    """The candidate with friction, where that is free, that rises from the speed ``fade`` on, over its deviation.

    Its descent comes down from a higher noise level, where the cost is smooth: a rise lies beyond where a fit without
    one leads.
    """
    flt, theta, added = candidate.flt, candidate.theta.copy(), []
    for end in ENDS:
        if INDEX[f"coulomb{end}"] in candidate.free:
            added += [INDEX[f"rise{end}"], INDEX[f"fade{end}"]]
            theta[added[-2:]] = RISE, np.log(fade * flt.speed_deviation)
    free, lowest = sorted({*candidate.free, *added}), replace(flt, level=flt.floor)
    found = descend(candidate.start, lowest, theta, free, box, FITTED_LEVEL, STEPS)
    return replace(found, flt=flt)


def friction_lines(candidate: Candidate, speeds: tuple[Array, Array] | None = None) -> dict[str, float]:
    """Coulomb (Nm) and viscous friction (Nm s/rad) of either end: the line closest to the curve at the speeds at which
    it moves, of load and motor, those of the candidate if none are given.

    A viscous friction below zero is none.
    """
    values = candidate.values
    lines: dict[str, float] = {}
    for which, end in enumerate(ENDS):
        coulomb, viscous, rise = (values[f"{name}{end}"] for name in ("coulomb", "viscous", "rise"))
        if coulomb * rise > 0.0:
            size = (speeds or candidate.speeds)[which]
            slope, offset = np.polyfit(size, rise * coulomb * np.exp(-size / values[f"fade{end}"]), 1)
            coulomb, viscous = coulomb + float(offset), max(viscous + float(slope), 0.0)
        lines |= {f"coulomb{end}": coulomb, f"viscous{end}": viscous}
    return lines

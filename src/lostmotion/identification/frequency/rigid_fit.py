"""The rigid drive that a response fits, and whether a torsional mode fits it better than by chance."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .fit_problem import NEIGHBOURS, WeightedResponse, theta_of
from .two_mass_response import two_mass_response

Floats = NDArray[np.float64]

#: Pole of a shaft that counts as rigid, over the highest frequency (numerics: its response differs by 1e-6).
RIGID = 1e3
#: What a rigid drive has.
FREE = ("inertia_motor", "inertia_load", "viscous", "delay")
#: Parameters that a mode adds: zero, pole, damping (physics).
ADDED = 3


def rigid_start(problem: WeightedResponse) -> Floats:
    """Both inertias alike, joined by a shaft without a mode in the band; their sum from response over model."""
    how = problem.measured.sampling
    rate = 2.0 * math.pi * RIGID * float(problem.frequency[-1])
    unit = {"inertia_motor": 0.5, "inertia_load": 0.5, "stiffness": 0.25 * rate**2, "damping": 0.25 * rate}
    shape = two_mass_response(unit, how.source, problem.s) * problem.s**how.power
    total = float(np.exp(np.median(np.log(np.abs(shape / problem.response)))))
    return theta_of({name: value * total for name, value in unit.items()})


def chance_of_a_mode(problem: WeightedResponse, theta: Floats, rigid: Floats) -> float:
    """Probability that noise alone makes a mode somewhere in the band fit so much better than the rigid drive.

    By the likelihood ratio of both fits. Where there is no mode its frequency means nothing, and a fit takes the best
    of as many places as there are lines (Davies 1987, Biometrika 74, 33-43): the chance at one place counts that often.
    """
    from scipy.stats import chi2

    deviation = problem.deviation(theta)
    gain = problem.cost(rigid, deviation) - problem.cost(theta, deviation)
    return float(min(1.0, problem.frequency.size * chi2.sf(gain / NEIGHBOURS, ADDED)))

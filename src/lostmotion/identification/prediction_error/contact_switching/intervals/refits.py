"""How far a fit shifts: from other rows, with more noise, and under another law of the contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ....statistics.block_covariance import student_factor
from ..estimate import distance, scatter
from ..filter import ContactFilter
from ..likelihood import FITTED_LEVEL, Box, Candidate, cost_of, descend, polish, side_by_side

Array = NDArray[np.float64]

#: Noise level over the sensor's: the filter follows the measured speed less, and foretells it over a longer time.
#: (Numerics: the next level that a descent comes through is five times higher.)
MORE_NOISE = 3.0


def disagreement(best: Candidate, under_laws: Sequence[Candidate], box: Box) -> Array:
    """(8,) largest distance of other fits from the best, in the logarithm; of other rows and more noise as far as they
    tell a value.

    Where the model is right, each half of the rows tells the same but for chance, and so does a filter that counts on
    more noise. Where it is not, the values make up for what it lacks, and by how much depends on the rows and on how
    far ahead the filter looks. A law of the contact is known no better than the recording is explained.
    """
    half = best.flt.rows // 2
    # All rows first: they take as long as both halves beside them.
    parts = [replace(best.flt, level=MORE_NOISE * best.flt.level)]
    halves = [best.flt.part(rows) for rows in (slice(0, half), slice(half, best.flt.rows))]
    parts += [rows for rows in halves if rows.moves]  # a standstill tells nothing

    def again(flt: ContactFilter) -> Candidate:
        # From a higher noise level, where the cost is smooth: a fit that cannot get away proves nothing.
        found = descend(best.start, replace(flt, level=flt.floor), best.theta, best.free, box, FITTED_LEVEL)
        # A descent that ends where these rows are predicted worse than beside the best shows no shift.
        ends = [replace(one, flt=replace(flt, level=flt.level)) for one in (found, best)]
        return min((polish(one, flt, box) for one in ends), key=cost_of)

    error, shifts = scatter(best)[1], []
    # The fit of all rows is the mean of those of its parts, each by its information: one that hardly tells a value
    # moves it little. So it is with more noise.
    for one in side_by_side(again, parts):
        shift, part = _beyond_chance(one, best, error)
        counts = np.minimum(part * best.flt.rows / one.flt.rows, 1.0)
        with np.errstate(invalid="ignore"):  # a fit without such a value is as far away as can be
            shifts.append(np.where(np.isinf(shift), np.inf, counts * shift))
    unexplained = max(best.cost, 0.0)
    shifts += [distance(one, best) for one in under_laws if one.cost < best.cost + unexplained]
    return np.asarray(np.max(shifts, axis=0))


def _beyond_chance(other: Candidate, best: Candidate, of_best: Array) -> tuple[Array, Array]:
    """(8,) distance of another fit from the best, less what noise makes of it, and (8,) its part of the information;
    ``of_best`` (8,) are the best's standard errors.

    The best knows its values better: the variance of the difference is the difference of the variances. Source: Hausman
    (1978), Specification tests in econometrics, Econometrica 46, lemma 2.1.
    """
    away, error = distance(other, best), scatter(other)[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        chance = student_factor(1) * np.sqrt(np.maximum(error**2 - of_best**2, 0.0))
        shift = np.where(away > chance, np.sqrt(away**2 - chance**2), 0.0)
        return shift, np.where(shift > 0.0, np.minimum((of_best / error) ** 2, 1.0), 0.0)

"""Whether the recording shows a part that the model lacks, and how far that may change the values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from ....statistics.block_covariance import student_factor
from ...innovations import NAMES as TOLD
from ..estimate import beyond_chance, shown
from ..filter import Run
from ..likelihood import Candidate
from ..told import told_slopes

Array = NDArray[np.float64]

#: Part of an effect that is left beside the parameters from which on there is one (numerics: far above rounding).
LEFT = 1e-6
#: Chance that white innovations show one of several effects (numerics: three standard deviations).
CHANCE = 0.00135


def shows(best: Candidate, effects: Sequence[Array]) -> bool:
    """Whether the innovations have one of these effects (n,) for certain, beside what the parameters make up for.

    An effect is what another part changes of the weighted innovations, or what another model predicts otherwise. Source
    for the first: see ``room_by_score``; for the second: Davidson and MacKinnon (1981), Several tests for model
    specification in the presence of alternative hypotheses, Econometrica 49, section 2.
    """
    basis = _beside(best)[0]
    rest = best.run.weighted - basis @ (basis.T @ best.run.weighted)
    deviation = np.sqrt(np.mean(rest**2))
    limit = norm.isf(0.5 * CHANCE / max(len(effects), 1))
    for effect in effects:
        if not np.all(np.isfinite(effect)):
            continue  # such a model loses the motion
        left = effect - basis @ (basis.T @ effect)
        size = np.linalg.norm(left)
        if size > LEFT * np.linalg.norm(effect) and abs(rest @ left) > limit * size * deviation:
            return True
    return False


def _beside(best: Candidate) -> tuple[Array, Array, Array]:
    """Orthonormal basis (n, m) of what the m parameters that show can make up for, the triangle (m, m) and the scale
    (m,) that make their sensitivities of it."""
    jacobian = best.run.jacobian[shown(best)]
    scale = np.linalg.norm(jacobian, axis=1)
    basis, triangle = np.linalg.qr((jacobian / scale[:, None]).T)
    return basis, triangle, scale


def room_by_score(best: Candidate, missing: Sequence[tuple[Array, Array | None]], most: float) -> Array:
    """(8,) largest change of the values by a part that the model lacks.

    Each such part adds ``size``·``effect`` to the innovations and, if it has any of its own, ``size``·``change`` to the
    values. The other parameters make up for some of its effect; that changes the values as well. What is left shows how
    large it is: a score test. Source: Rao (1948), Large sample tests of statistical hypotheses concerning several
    parameters, Mathematical Proceedings of the Cambridge Philosophical Society 44, section 2.

    Parameters
    ----------
    missing : pairs of (n,) effect on the weighted innovations and (8,) change of the values, of a part of size 1
    most : float
        Its size at most.
    """
    run, seen = best.run, shown(best)
    if not np.any(seen):
        return np.zeros(len(TOLD))
    slopes = told_slopes(best)[:, seen]
    basis, triangle, scale = _beside(best)
    width = student_factor(1) * beyond_chance(best) * np.sqrt(np.mean(run.weighted**2))
    largest = np.zeros(len(TOLD))
    for effect, own in missing:
        if not np.all(np.isfinite(effect)):
            continue
        made_up = basis.T @ effect
        left = effect - basis @ made_up
        with np.errstate(divide="ignore", invalid="ignore"):
            size = np.hypot(run.weighted @ left / (left @ left), width / np.linalg.norm(left))
        change = -slopes @ (np.linalg.lstsq(triangle, made_up)[0] / scale)
        change = change if own is None else change + own
        largest = np.maximum(largest, np.fmin(size, most) * np.abs(change))
    return largest


def change_by(other: Run, run: Run) -> Array:
    """Change of a pass's weighted innovations to another's, with the deviations as they are."""
    change, n = np.zeros(run.weighted.size), run.rows.size
    change[:n] = other.weighted[:n] * other.deviations / run.deviations - run.weighted[:n]
    return change

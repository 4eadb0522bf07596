"""How far a part that the model lacks may change the values: as far as the recording leaves it open."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ....statistics.block_covariance import student_factor
from ...innovations import NAMES as TOLD
from ..estimate import beyond_chance, shown
from ..filter import Run
from ..likelihood import Candidate
from ..told import told_slopes

Array = NDArray[np.float64]


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
    jacobian, slopes = run.jacobian[seen], told_slopes(best)[:, seen]
    scale = np.linalg.norm(jacobian, axis=1)
    basis, triangle = np.linalg.qr((jacobian / scale[:, None]).T)
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

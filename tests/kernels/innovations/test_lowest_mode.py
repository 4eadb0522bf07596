"""The lowest mode of a chain of four inertias: against the eigenvalues of its matrices."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.kernels.innovations.intermediate_inertia import lowest_mode


@pytest.mark.parametrize("decades", [0.5, 2.0, 4.0])
def test_the_lowest_mode_is_the_least_eigenvalue(decades: float):
    """Inertias and stiffnesses over many decades: Newton's steps come from below and do not step beyond it."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        masses, springs = 10.0 ** rng.uniform(-decades, decades, 4), 10.0 ** rng.uniform(-decades, decades, 3)
        twists = np.diff(np.eye(4), axis=0)  # of each shaft, per angle
        # The twists' own equation is symmetric in the roots of the stiffnesses.
        roots = np.sqrt(springs)[:, None] * twists
        exact = np.linalg.eigvalsh(roots @ np.diag(1.0 / masses) @ roots.T)
        found = lowest_mode(tuple(masses), tuple(springs))
        # What the eigenvalues are computed to.
        assert found == pytest.approx(exact[0], rel=1e-9, abs=1e-13 * exact[-1])

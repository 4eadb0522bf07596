"""Likelihood of innovations whose noise is uniform, beside the formula."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ndtr

from lostmotion.kernels.numerics.uniform_noise import HALF, fill_unlikelihood


@pytest.mark.parametrize("error", [0.05, 0.5, 3.0])
@pytest.mark.parametrize("outliers", [0.0, 0.01])
def test_it_is_a_uniform_and_a_gaussian_density_together(error: float, outliers: float):
    at = np.linspace(-HALF - 3.0 * error, HALF + 3.0 * error, 301)
    variances, rows = np.full(at.size, 1.0 + error**2), np.empty(at.size)
    fill_unlikelihood(at, variances, 0.01, outliers, rows)
    within = ndtr((at + HALF) / error) - ndtr((at - HALF) / error)
    gaussian = np.exp(-0.5 * at**2 / variances) / np.sqrt(2.0 * np.pi * variances)
    assert np.exp(-rows) == pytest.approx(
        (1.0 - outliers) * within + outliers * 2.0 * HALF * gaussian, abs=1e-8
    )
    assert np.sum(np.exp(-rows)) * (at[1] - at[0]) == pytest.approx(2.0 * HALF, rel=0.01)


def test_what_has_no_likelihood_is_infinitely_unlikely():
    rows = np.empty(2)
    fill_unlikelihood(np.array([0.0, 1e3]), np.ones(2), 0.05, 0.01, rows)
    assert rows[0] == pytest.approx(0.0, abs=0.01) and np.isinf(rows[1])

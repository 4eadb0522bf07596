"""The likelihood of innovations whose noise is the rounding of counts."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.sensor.rounding import (
    LEAST,
    cost_as_gaussian,
    unlikelihood,
)

#: Half of a count over the standard deviation of its rounding.
HALF = np.sqrt(3.0)


def _innovations(error: float, n: int = 40_000) -> np.ndarray:
    rng = np.random.default_rng(1)
    return rng.uniform(-HALF, HALF, n) + error * rng.standard_normal(n)


def test_it_is_that_of_a_uniform_noise():
    """Within a count all are as likely, beyond its edge hardly any; per count, so that the logarithm is zero there."""
    rows = unlikelihood(np.array([0.0, 1.0, -1.5, HALF, -2.2]), np.ones(5))
    assert np.allclose(rows[:3], 0.0, atol=0.01)
    assert rows[3] == pytest.approx(np.log(2.0), abs=0.05)
    assert rows[4] > 4.0
    wide = unlikelihood(np.array([0.0, 3.0]), np.full(2, 101.0))
    assert np.allclose(
        wide, 0.5 * np.log(2.0 * np.pi * 101.0) + np.array([0.0, 9.0 / 202.0]) - np.log(2.0 * HALF), atol=2e-3
    )


@pytest.mark.parametrize("error", [LEAST, 0.2, 1.0, 5.0, 60.0])
def test_the_cost_is_that_of_gaussian_noise_as_large(error: float):
    mean = float(np.mean(unlikelihood(_innovations(error), np.full(40_000, 1.0 + error**2))))
    assert cost_as_gaussian(mean) == pytest.approx(0.5 * np.log1p(error**2), rel=0.05, abs=2e-4)


def test_what_follows_the_pattern_of_the_rounding_costs_more_than_the_truth():
    """A slow motion's rounding has a pattern. A filter that follows it has smaller innovations than rounding alone, as
    Gaussian noise they would be likelier; beyond the edges of a count they are not."""
    angle = np.arange(20_000) * 3.02
    rounding = (np.round(angle) - angle) * 2.0 * HALF
    followed = rounding[1:] - 0.9 * rounding[:-1]
    spread = float(np.var(followed))
    assert spread < 0.9
    true = np.mean(unlikelihood(rounding, np.full(rounding.size, 1.0 + LEAST**2)))
    # Whatever the filter takes for the size of its errors.
    for error in (LEAST, 0.1, 0.3, 0.6):
        assert np.mean(unlikelihood(followed, np.full(followed.size, 1.0 + error**2))) > true + 0.03

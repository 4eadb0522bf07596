"""What a filter takes the gap for where it does not know on which side of an edge it is."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.kernels.innovations.gap_in_doubt import mean_gap

HALF = 0.1


@pytest.mark.parametrize(("z", "deviation"), [(0.1, 0.01), (0.07, 0.02), (-0.12, 0.02), (0.02, 0.2)])
def test_the_mean_gap_is_that_of_many_draws(z: float, deviation: float):
    """Mean, slope and rest of the spring's twist, as a blend of the open and the closed spring makes them."""
    draws = z + deviation * np.random.default_rng(1).standard_normal(400_000)
    twist = draws - np.clip(draws, -HALF, HALF)
    chance, edge, rest = mean_gap(z, HALF, deviation)
    assert chance * (z - edge) == pytest.approx(np.mean(twist), abs=0.01 * deviation)
    slope = np.cov(twist, draws)[0, 1] / np.var(draws)
    assert chance == pytest.approx(slope, abs=0.01)
    assert rest == pytest.approx(np.var(twist) - slope**2 * deviation**2, abs=0.01 * deviation**2)

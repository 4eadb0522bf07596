"""The size of white noise in a smooth signal."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.statistics.white_noise import white_noise


@pytest.mark.parametrize("rows", [2000.0, 50.0, 7.0], ids="{:.0f} rows in a period".format)
def test_noise_of_a_smooth_signal_is_seen(rows: float):
    row = np.arange(20_000)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(row.size)
    assert white_noise(10.0 * np.sin(2.0 * np.pi * row / rows) + noise) == pytest.approx(1e-3, rel=0.05)

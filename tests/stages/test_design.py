"""The design of the laws: what counts as noise of the measured speed."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.stages.design import _sensor_noise


@pytest.mark.parametrize("model_error", [0.0, 1.0])
def test_slow_innovations_are_no_noise(model_error: float) -> None:
    """Else a drive whose friction the model has not got a law of minutes, as one of the zoo did."""
    time = 1e-3 * np.arange(20_000)
    noise = 0.02 * np.random.default_rng(1).normal(size=time.size)
    assert _sensor_noise(model_error * np.sin(10.0 * time) + noise) == pytest.approx(0.02, rel=0.03)


def test_counts_are_noise() -> None:
    """Of an encoder: differences of rounding errors, √2 of a step over √12."""
    angle = np.cumsum(np.random.default_rng(2).normal(size=20_000))
    rounding = np.round(angle) - angle
    assert 1.0 < _sensor_noise(np.diff(rounding)) / np.sqrt(1.0 / 6.0) < 1.4

"""The design of the laws: what counts as noise of the measured speed."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import pi
from lostmotion.drivetrain import Drivetrain
from lostmotion.stages.design import _sensor_noise, _soft_landing


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


@pytest.mark.parametrize(("noise", "lands"), [(0.01, True), (1.0, False)])
def test_soft_landing_is_left_out_where_noise_would_chatter(noise: float, lands: bool) -> None:
    """J/(lag + dt) is 36 Nm s/rad: a noise of 1 rad/s asks for half of 70 Nm and more."""
    drive = Drivetrain.two_mass(
        inertia_motor=0.018, inertia_load=0.11, stiffness=6000.0, backlash=0.012, lag=4e-4
    )
    law, skipped = _soft_landing(drive, 70.0, noise, 1e-4, lambda *_, **__: pi(dt=1e-4))
    assert (law is not None) == lands
    assert skipped == "" if lands else "51 % of the torque limit" in skipped

"""What keeps a default law from being handed out: margin and noise of PI's gains."""

from __future__ import annotations

import math

import pytest

from lostmotion.controllers import symmetrical_optimum
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.stages.fitness import check_gains

DT = 1e-4
DRIVE = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip


def test_gains_that_keep_both_are_taken() -> None:
    check_gains(symmetrical_optimum(DRIVE, dt=DT, spread=None, largest_noise_gain=0.5), 0.5)


def test_a_margin_that_only_noisy_gains_keep_is_refused() -> None:
    """No gain is as small as this noise would ask for: those of the best margin alone would chatter."""
    tuning = symmetrical_optimum(DRIVE, dt=DT, spread=None, largest_noise_gain=1e-9)
    assert tuning.stable and tuning.noise_gain > 1e-9
    with pytest.raises(InvalidInput, match="noise of the measured speed"):
        check_gains(tuning, 1e-9)
    # Of all that miss the limit, those are taken that miss it least.
    assert tuning.noise_gain < 1e-2 * symmetrical_optimum(DRIVE, dt=DT, spread=None).noise_gain


def test_a_loop_that_is_unstable_with_any_gains_is_refused() -> None:
    # The classical spread at a sample time that is too long for the mode, see tests/controllers/tuning.
    tuning = symmetrical_optimum(DRIVE.with_parameters(damping=0.042, backlash=0.0), dt=1e-3)
    assert math.isinf(tuning.sensitivity) and math.isinf(tuning.noise_gain)
    with pytest.raises(InvalidInput, match="an unstable loop with any gains"):
        check_gains(tuning, math.inf)

"""What keeps a default law from being handed out: margin and noise of PI's gains, and a poor response."""

from __future__ import annotations

import math

import pytest
from servo_drive import DRIVE

from lostmotion.controllers import pi, symmetrical_optimum
from lostmotion.errors import InvalidInput
from lostmotion.metrics import StepMetrics
from lostmotion.stages.fitness import check_gains, check_responses, overshoots, responses
from lostmotion.stages.possible_drives import simulated_drives
from lostmotion.stages.speed_step import SpeedStep

DT = 1e-4


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


def metrics(overshoot: float = 0.0, steady_error: float = 0.0, settles: bool = True) -> StepMetrics:
    return StepMetrics(overshoot, 0.1, 0.2 if settles else None, 1.0, steady_error)


@pytest.mark.parametrize(
    ("poor", "reason"),
    [
        (metrics(overshoot=11.0), "an overshoot of 11 % of the step"),
        (metrics(steady_error=0.02), "2 % of the step left"),
        (metrics(steady_error=0.5, settles=False), "50 % of the step left"),
    ],
)
def test_a_poor_response_on_one_of_the_drives_is_named(poor: StepMetrics, reason: str) -> None:
    check_responses("pi", {"its own model": metrics(overshoot=7.0, steady_error=0.004)})
    with pytest.raises(InvalidInput, match=f"controller pi with a heavy load: got {reason}"):
        check_responses("pi", {"its own model": metrics(), "a heavy load": poor})


def test_only_what_settles_overshoots() -> None:
    """A slower set-point filter helps against overshoot, and not where the load never arrives."""
    assert overshoots({"a": metrics(), "b": metrics(overshoot=11.0)})
    assert not overshoots({"a": metrics(overshoot=7.0), "b": metrics(overshoot=60.0, settles=False)})


def test_a_law_is_simulated_on_what_the_drive_may_be() -> None:
    known = simulated_drives(DRIVE, frozenset(), 20.0)
    assert list(known.values()) == [DRIVE]
    unknown = frozenset({"inertia_load", "lag", "coulomb", "viscous"})
    rubs = simulated_drives(DRIVE.with_parameters(coulomb=0.0), unknown, 20.0)
    assert [(drive.inertia_motor, drive.inertia_load, drive.lag, drive.coulomb) for drive in rubs.values()] == [
        (0.0195, 0.111, 3e-4, 0.0), (0.0195, 0.222, 2e-3, 0.0), (0.0195, 0.0555, 2e-3, 0.0), (0.0195, 0.111, 3e-4, 20.0)
    ]  # fmt: skip
    # A nameplate's friction is off either way, but not above the torque under which the drive turned.
    for usual, levels in ((20.0, [1.0, 4.0]), (3.0, [1.0, 3.0]), (1.0, [1.0])):
        rubs = simulated_drives(DRIVE, unknown, usual)
        assert [drive.coulomb for drive in rubs.values()][3:] == levels
    assert rubs["a smaller friction"].viscous == 0.5 * DRIVE.viscous


def test_without_friction_a_load_is_judged_with_a_little() -> None:
    """Else it would float in its gap for ever, with any law."""
    law, floats = (
        pi(dt=DT, **symmetrical_optimum(DRIVE, dt=DT, spread=None).gains()),
        DRIVE.with_parameters(coulomb=0.0),
    )
    found = responses(law, {"with": DRIVE, "without": floats}, SpeedStep(-2.0, 2.0, 0.3, 0.6, 0.9), DT)
    assert all(one.settling_time is not None and one.steady_error < 0.005 for one in found.values())

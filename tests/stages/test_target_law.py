"""The default law: its poles follow the drive, its margin is what the loop has, nothing steady is left."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from servo_drive import DRIVE

from lostmotion.certificates import margins
from lostmotion.metrics import step_metrics
from lostmotion.simulation import simulate
from lostmotion.stages.target_law import (
    DELAY,
    MODE,
    NOISE,
    POLES_SENSITIVITY,
    default_poles,
    law_margin,
    target_law,
)

DT = 1e-4


def test_the_default_keeps_its_margin_and_says_what_limits_it() -> None:
    soft = DRIVE.with_parameters(stiffness=65.0, damping=0.042, backlash=0.0)
    for drive, dt, limit in ((soft, DT, MODE), (DRIVE, 1e-3, DELAY)):
        poles = default_poles(drive, dt, False)
        assert poles.source == limit
        assert law_margin(drive, poles.values, dt, False).sensitivity <= POLES_SENSITIVITY


def test_it_has_a_margin_in_every_contact_state() -> None:
    """30° is the least that is usual (Åström & Murray 2021, Feedback Systems, section 10.3); the gap open and the load
    held are not what the poles are chosen by."""
    law = target_law(DRIVE, default_poles(DRIVE, DT, True).values, 70.0, DT, True)
    found = margins(DRIVE, law, delay=1, torque_load=-20.0)
    assert len(found) == 4
    for state, margin in found.items():
        assert margin.stable and margin.phase is not None, state
        assert math.degrees(margin.phase) > 30.0 and margin.disk > 0.5 and margin.delay > 5e-4, state


def test_late_and_noisy_drives_get_slower_laws() -> None:
    usual = default_poles(DRIVE, DT, True)
    late = default_poles(replace(DRIVE, actuator=replace(DRIVE.actuator, lag=2e-3)), DT, True)
    noisy = default_poles(DRIVE, DT, True, largest_noise_gain=0.5)
    assert late.slowest < 0.5 * usual.slowest and noisy.slowest < 0.7 * usual.slowest
    assert noisy.source == NOISE
    assert law_margin(DRIVE, noisy.values, DT, True).torque_per_speed_noise <= 0.5


def test_the_margin_sees_what_the_simulation_sees() -> None:
    """Poles far too fast: unstable in both."""
    poles = (-2500.0,) * 3
    assert math.isinf(law_margin(DRIVE, poles, DT, False).sensitivity)
    run = simulate(
        DRIVE, dt=DT, law=target_law(DRIVE, poles, 70.0, DT, False), delay=1, speed_reference=np.ones(5000)
    )
    assert np.std(run["torque_motor"][-1000:]) > 10.0


@pytest.mark.parametrize("wrong", [{"coulomb": 2.6}, {"viscous": 0.05}, {"coulomb_motor": 0.5}])
def test_wrong_friction_leaves_no_steady_error(wrong: dict[str, float]) -> None:
    """The load torque of the observer takes it up: 3 to 7 % of the step were left without it."""
    law = target_law(DRIVE, default_poles(DRIVE, DT, False).values, 70.0, DT, False)
    reference = np.where(np.arange(10_000) < 5000, -2.0, 2.0)
    run = simulate(DRIVE.with_parameters(**wrong), dt=DT, law=law, delay=1, speed_reference=reference)
    judged = step_metrics(run.time, run["speed_load"], 0.5, -2.0, 2.0)
    assert judged.steady_error < 1e-3 and judged.overshoot < 10.0


def test_a_load_torque_leaves_no_steady_error() -> None:
    law = target_law(DRIVE, default_poles(DRIVE, DT, False).values, 70.0, DT, False)
    push = np.where(np.arange(10_000) < 5000, 0.0, -10.0)
    run = simulate(DRIVE, dt=DT, law=law, delay=1, speed_reference=np.full(10_000, 2.0), torque_load=push)
    assert abs(np.mean(run["speed_load"][-1000:]) - 2.0) < 0.01

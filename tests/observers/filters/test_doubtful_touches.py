"""A touch of the gap that the estimate only believes in: Kalman filters that track parameters take it back."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion.drivetrain import Drivetrain
from lostmotion.kernels.estimators.parameter_tracking import (
    COVARIANCE,
    EASE_LOAD,
    EASE_MOTOR,
    FACTOR,
    IMPULSE,
    ODDS,
    PULL,
    WIDE,
    WIDE_SPEED,
    N,
    judge_touch,
    new_state,
)
from lostmotion.kernels.estimators.two_mass_model import DT as SAMPLE
from lostmotion.kernels.estimators.two_mass_model import INERTIA_LOAD, INERTIA_MOTOR
from lostmotion.observers import extended_kalman, unscented_kalman
from lostmotion.signals import excitation
from lostmotion.simulation import Sensor, measure, simulate

DT = 1e-4
LEVELS = (4.0, 10.0, -4.0, -10.0, 6.0, -6.0)


def stiff(stiffness, **contact):
    """The paper's rig with a stiffer shaft."""
    return Drivetrain.two_mass(
        inertia_motor=0.0182, inertia_load=0.111, stiffness=stiffness, backlash=0.012, coulomb=2.0,
        damping=0.397 * math.sqrt(stiffness / 6285.896), viscous=0.0175, **contact,
    )  # fmt: skip


@pytest.mark.parametrize(("make", "largest"), [(extended_kalman, 0.015), (unscented_kalman, 0.02)])
@pytest.mark.parametrize("stiffness", [5e4, 1e5])
@pytest.mark.parametrize("seed", [2, 3])
def test_a_gap_that_is_wide_against_the_winding_is_not_lost(make, largest, stiffness, seed):
    """9.7 Nm wind the shaft by 1/62 and 1/124 of its gap: the error was 4 to 19 % of the range."""
    torque = excitation(
        1.5, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175, levels=LEVELS, ramp=0.1, noise_rms=7.0,
        limit=1e9,
    )  # fmt: skip
    exact = simulate(stiff(stiffness, contact="dead_zone"), dt=DT, torque_motor=torque)
    sensors = {"speed_motor": Sensor("angle_motor", 2.0 * math.pi / 2**20, difference=True)}
    shown = {"torque_motor": torque, **measure(sensors, exact.signals, DT, seed)}
    found = make(stiff(stiffness), dt=DT, speed_from_counts=True).run(shown)
    load = exact["speed_load"][3000:]
    wrong = found["speed_load_estimated"][3000:] - load
    assert np.sqrt(np.mean(wrong**2)) < largest * np.ptp(load)
    assert found["backlash_estimated"][-1] == pytest.approx(0.012, rel=0.1)


def touching(pull, wide):
    """Parameters and state of a filter that expects ``pull``, with the deviation ``wide`` before the touch, rad."""
    p = extended_kalman(stiff(5e4), dt=DT).parameters
    s = new_state(p)
    s[FACTOR] = s[EASE_MOTOR] = s[EASE_LOAD] = 1.0
    s[0], s[2], s[PULL], s[WIDE], s[WIDE_SPEED] = 6.4e-3, 3.0, pull, wide**2, 0.1**2
    return p, s


def judged(p, s, innovation, samples=6, deviation=0.05):
    for _ in range(samples):
        judge_touch(p, s, innovation, deviation**2)


def test_a_touch_that_the_speed_contradicts_is_taken_back():
    p, s = touching(20.0, 1e-3)
    variances = s[COVARIANCE], s[COVARIANCE + 2 * N + 2]
    effect = (
        20.0 * p[SAMPLE] / p[INERTIA_MOTOR]
    )  # rad/s in a sample, 2.2 deviations: as if there were no torque
    judge_touch(p, s, effect, 0.05**2)
    assert s[0] == 6.4e-3  # not after one sample
    judge_touch(p, s, effect, 0.05**2)
    assert s[0] == pytest.approx(5e-3)
    assert s[2] == pytest.approx(3.0 - 2.0 * 20.0 * p[SAMPLE] / p[INERTIA_LOAD])
    assert s[COVARIANCE] == pytest.approx(variances[0] + 1e-6)
    assert s[COVARIANCE + 2 * N + 2] == pytest.approx(variances[1] + 0.01)
    assert s[ODDS] == s[IMPULSE] == 0.0


def test_on_the_other_side_it_is_taken_back_to_there():
    p, s = touching(-20.0, 1e-3)
    judged(p, s, -20.0 * p[SAMPLE] / p[INERTIA_MOTOR], 2)
    assert s[0] == pytest.approx(-5e-3)
    assert s[2] == pytest.approx(3.0 + 2.0 * 20.0 * p[SAMPLE] / p[INERTIA_LOAD])


@pytest.mark.parametrize(
    ("pull", "wide", "innovation"),
    [(20.0, 1e-3, 0.0), (20.0, 1e-3, -0.1), (20.0, 8e-5, 0.11), (0.0, 1e-3, 0.11)],
    ids=["as predicted", "more torque still", "no room for a doubt", "in the gap"],
)
def test_otherwise_a_touch_stays(pull, wide, innovation):
    p, s = touching(pull, wide)
    before = s.copy()
    judged(p, s, innovation)
    assert np.array_equal(s, before)

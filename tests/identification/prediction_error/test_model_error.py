"""The detection of unmodelled modes."""

from __future__ import annotations

import numpy as np
import pytest
from slow_axis import AXIS
from table_i import PAPER

import lostmotion as lm
from lostmotion.identification.prediction_error.initial_values import rigid_body
from lostmotion.identification.prediction_error.model_error import (
    model_allowance,
    unmodelled_mode,
)
from lostmotion.identification.prediction_error.warnings import count_step
from lostmotion.identification.statistics.levenberg_marquardt import minimise

DT = 1e-4


def test_minimise_stays_within_bounds_and_ends():
    target = np.array([3.0, -1.0])

    def residual(theta: np.ndarray) -> np.ndarray:
        return np.concatenate([theta - target, [np.sin(theta[0])]])

    def jacobian(theta: np.ndarray, _: np.ndarray) -> np.ndarray:
        return np.array([[1.0, 0.0, np.cos(theta[0])], [0.0, 1.0, 0.0]])

    fit = minimise(residual, jacobian, np.zeros(2), [0, 1], np.array([-9.0, -0.5]), np.array([9.0, 9.0]), 30)
    assert fit.converged and fit.iterations < 30
    assert fit.theta[1] == -0.5
    assert fit.theta[0] == pytest.approx(3.07, abs=0.01)
    short = minimise(residual, jacobian, np.zeros(2), [0, 1], np.full(2, -9.0), np.full(2, 9.0), 1)
    assert not short.converged and short.iterations == 1


@pytest.mark.parametrize("blue", [True, False])
def test_a_mode_is_told_from_noise(blue: bool):
    rng = np.random.default_rng(5)
    n = 100000
    time = np.arange(n) * DT
    noise = 0.02 * (np.diff(rng.standard_normal(n + 1)) if blue else rng.standard_normal(n))
    speed = 2.0 * np.sin(2.0 * np.pi * 90.0 * time)
    assert unmodelled_mode(noise, speed, DT, blue, 100.0) is None
    ringing = noise + 0.05 * np.sin(2.0 * np.pi * 740.0 * time)
    assert unmodelled_mode(ringing, speed, DT, blue, 100.0) == pytest.approx(740.0, abs=10.0)
    assert unmodelled_mode(ringing, 100.0 * speed, DT, blue, 100.0) is None, "too small to matter"


def test_allowance_grows_with_the_square_of_the_frequency_ratio():
    drivetrain = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0)
    names = ("inertia_motor", "inertia_load", "coulomb")
    pole = drivetrain.pole_frequency
    near, far = (model_allowance(names, drivetrain, 1e-6, factor * pole) for factor in (5.0, 10.0))
    assert near == pytest.approx([2.0 / 25.0, 2.0 / 25.0 / 5.0, 0.015], rel=1e-3, abs=1e-6)
    rubbing = drivetrain.with_parameters(coulomb=2.0, viscous=0.02)
    assert model_allowance(("viscous",), rubbing, 1e-6, 5.0 * pole, speed=20.0) == pytest.approx(
        [0.075], rel=1e-3
    )
    joint = model_allowance(names, drivetrain, 1e-6, 5.0 * pole, joint=True)
    assert joint == pytest.approx(near * [0.5, 0.5, 1.0])
    more = model_allowance(names, drivetrain, 1e-6, 5.0 * pole, further=True)
    assert more == pytest.approx(near * [1.0, 2.0, 1.0])
    assert far[0] == pytest.approx(near[0] / 4.0, rel=1e-3)
    assert model_allowance(names, drivetrain, DT, None) == pytest.approx(
        [0.5 * (2.0 * np.pi * pole * DT) ** 2] * 3
    )
    assert model_allowance(names, drivetrain, DT, None, sampled=True) == pytest.approx([0.0] * 3)


def test_quantised_speeds():
    rng = np.random.default_rng(6)
    speed = 10.0 + np.cumsum(rng.standard_normal(20000)) * 0.02
    assert count_step(speed) is None
    assert count_step(np.round(speed / 0.06) * 0.06) == pytest.approx(0.06)
    counted = np.round(speed / 0.7) * 0.7
    assert count_step(counted) == pytest.approx(0.7)
    assert count_step(np.concatenate([np.zeros(50_000), counted])) == pytest.approx(0.7)  # at rest at first


def test_rigid_body_start():
    torque = lm.signals.excitation(10.0, DT, seed=2, inertia=0.12, coulomb=1.5, viscous=0.03)
    plant = PAPER.with_parameters(inertia_motor=0.03, inertia_load=0.09, coulomb=1.5, viscous=0.03)
    speed = lm.simulate(plant, torque_motor=torque, dt=DT)["speed_motor"]
    inertia, coulomb, viscous = rigid_body(torque, speed, DT, zero=38.0)
    assert inertia == pytest.approx(0.12, rel=0.05)
    assert coulomb == pytest.approx(1.5, rel=0.2)
    assert viscous == pytest.approx(0.03, rel=0.5)


def test_rigid_body_of_a_slow_axis():
    """Its zero at 3.9 Hz lies within the 8 Hz in which the rig turns as one."""
    held = np.repeat(np.random.default_rng(1).choice([-1.0, 1.0], 600), 36) * 135.0
    speed = lm.simulate(AXIS, torque_motor=held, dt=1e-3)["speed_motor"]
    assert rigid_body(held, speed, 1e-3, AXIS.zero_frequency)[0] == pytest.approx(52.0, rel=0.15)
    assert rigid_body(held, speed, 1e-3, 38.0)[0] < 26.0

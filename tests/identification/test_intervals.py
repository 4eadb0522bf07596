"""Intervals of a fit, and the box that it stays in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.gauss_newton import Fit
from lostmotion.identification.intervals import half_widths
from lostmotion.identification.ladder import FARTHEST, LADDER, Box, Stage, bandwidth_for, descend
from lostmotion.identification.predictor import NAMES, Predictor, from_theta, to_theta

DT = 1e-4
PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip
THETA = to_theta([getattr(PLANT, n) for n in NAMES], DT)


@pytest.fixture(scope="module")
def predictor() -> Predictor:
    torque = lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    speed = lm.simulate(PLANT, torque_motor=torque, dt=DT)["speed_motor"]
    noisy = speed + 0.02 * np.random.default_rng(1).standard_normal(speed.size)
    return Predictor(torque, noisy, DT, False, PLANT, skip=500)


def stage_at_truth(predictor: Predictor, free: list[int]) -> Stage:
    bandwidth = bandwidth_for(PLANT, LADDER[-1])
    residual = predictor.residual(THETA, bandwidth)
    return Stage(Fit(THETA, residual, float(residual @ residual), 1, True), bandwidth, free, 1)


def test_a_nameplate_value_that_had_to_be_taken_widens_the_others(predictor: Predictor):
    damping = NAMES.index("damping")
    stage = stage_at_truth(predictor, [i for i in range(len(NAMES)) if i != damping])
    _, known = half_widths(predictor, stage)
    _, taken = half_widths(predictor, replace(stage, unexcited=(damping,)))
    assert np.all(taken >= known)
    stiffness = stage.free.index(NAMES.index("stiffness"))
    assert taken[stiffness] > 1.5 * known[stiffness]


def test_more_free_parameters_are_known_less_well(predictor: Predictor):
    _, alone = half_widths(predictor, stage_at_truth(predictor, [5]))
    _, together = half_widths(predictor, stage_at_truth(predictor, [1, 5, 6]))
    assert together[1] > alone[0] > 0.0


def test_the_fit_stays_in_its_box(predictor: Predictor):
    start = THETA + np.log([30.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    box = Box.around(start, DT)
    stage = descend(predictor, start, list(range(len(NAMES))), box, lambda fraction, text: None)
    assert np.all(stage.fit.theta >= box.lower - 1e-12) and np.all(stage.fit.theta <= box.upper + 1e-12)
    assert from_theta(stage.fit.theta, DT)[0] >= 0.0182 * 30.0 / FARTHEST * (1.0 - 1e-9)


def test_no_lag_has_a_floor():
    theta = to_theta([getattr(PLANT.with_parameters(lag=0.0), n) for n in NAMES], DT)
    assert 0.0 < from_theta(Box.around(theta, DT).lower, DT)[-1] < 0.1 * DT

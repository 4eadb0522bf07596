"""Intervals of a fit, and the box that it stays in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from lagged_drive import DT, PLANT, THETA

import lostmotion as lm
from lostmotion.identification.prediction_error.gain_schedule import (
    FARTHEST,
    LADDER,
    Box,
    Stage,
    bandwidth_for,
    descent,
    fit,
)
from lostmotion.identification.prediction_error.identifiability import half_widths, without_unexcited
from lostmotion.identification.prediction_error.innovations import NAMES, Predictor, from_theta, to_theta
from lostmotion.identification.statistics.levenberg_marquardt import Fit


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
    stage = descent(predictor, start, list(range(len(NAMES))), box, lambda fraction, text: None)[-1]
    assert np.all(stage.fit.theta >= box.lower - 1e-12) and np.all(stage.fit.theta <= box.upper + 1e-12)
    assert from_theta(stage.fit.theta, DT)[0] >= 0.0182 * 30.0 / FARTHEST * (1.0 - 1e-9)


def test_no_lag_has_a_floor():
    theta = to_theta([getattr(PLANT.with_parameters(lag=0.0), n) for n in NAMES], DT)
    assert 0.0 < from_theta(Box.around(theta, DT).lower, DT)[-1] < 0.1 * DT


#: Sample time of a load that hardly moves, s.
SLOW = 2e-4
NAMEPLATE = lm.Drivetrain.two_mass(inertia_motor=0.018, inertia_load=0.1, stiffness=6000.0)


def told_of_a_held_load(torque: np.ndarray, nameplate: lm.Drivetrain) -> set[str]:
    """What is told of a load with 2 Nm of Coulomb torque; each of these torques alone leaves it nearly at rest."""
    run = lm.simulate(PLANT, torque_motor=torque, dt=SLOW)
    assert np.max(np.abs(run["speed_load"])) < 0.5
    noise = 1e-4 * np.random.default_rng(2).standard_normal(torque.size)
    recording = run.only("torque_motor").with_signals("measured", speed_motor=run["speed_motor"] + noise)
    found = lm.identify(recording, start=nameplate, speed_from_counts=False, second_estimator=False)
    for name in found.names:
        low, high = found.intervals[name]
        assert low <= getattr(PLANT, name) <= high, name
    return set(found.names)


def test_a_load_that_sticks_passes_for_nothing():
    """Without a nameplate for the gap the motor's few knocks fit a spring 14 times too soft."""
    square = np.where(np.arange(10000) < 5000, 1.0, -1.0)
    assert told_of_a_held_load(square, NAMEPLATE) & {"stiffness", "coulomb", "inertia_load"} == set()


def test_a_gap_that_is_crossed_once_is_not_told():
    """Room for the first knock is all that it takes: a much smaller gap predicts as well."""
    held = 1.0 + 0.1 * lm.signals.noise(2.0, 140.0, 1.0, 1.0, SLOW, seed=3)
    told = told_of_a_held_load(held, NAMEPLATE.with_parameters(backlash=0.01, coulomb=1.5))
    assert "backlash" not in told


def test_friction_that_only_holds_is_not_told(predictor: Predictor):
    """A torque that the load never gives way to: any larger friction predicts the same."""
    torque = 1.0 + 0.1 * lm.signals.noise(2.0, 140.0, 1.0, 2.0, DT, seed=3)
    stuck = PLANT.with_parameters(coulomb=40.0)
    speed = lm.simulate(stuck, torque_motor=torque, dt=DT)["speed_motor"]
    noisy = speed + 0.02 * np.random.default_rng(1).standard_normal(speed.size)
    held = Predictor(torque, noisy, DT, False, PLANT, skip=500)
    coulomb, box = NAMES.index("coulomb"), Box(THETA - 3.0, THETA + 3.0)
    for one, unexcited in ((held, (coulomb,)), (predictor, ())):
        stage = stage_at_truth(one, [0, coulomb])
        assert without_unexcited(one, stage, PLANT, box).unexcited == unexcited


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_what_only_the_box_holds_is_not_told(predictor: Predictor, factor: float):
    stiffness = NAMES.index("stiffness")
    box = Box(THETA - 1.0, THETA + 1.0)
    (box.upper if factor < 1.0 else box.lower)[stiffness] = THETA[stiffness] + np.log(factor)
    free, bandwidth = [0, stiffness], bandwidth_for(PLANT, LADDER[-1])
    found = fit(predictor, THETA, free, box, bandwidth)
    stage = without_unexcited(predictor, Stage(found, bandwidth, free, 1), PLANT, box)
    assert stage.unexcited == (stiffness,) and stage.free == [0]
    assert np.exp(stage.fit.theta[stiffness]) == pytest.approx(PLANT.stiffness)


def test_no_lag_is_told_though_the_box_holds_it(predictor: Predictor):
    """A lag above zero would predict worse: zero is a value, not a lack of information."""
    lag = NAMES.index("lag")
    box = Box(THETA - 1.0, THETA + 1.0)
    box.lower[lag] = THETA[lag] + 0.1
    bandwidth = bandwidth_for(PLANT, LADDER[-1])
    found = fit(predictor, THETA, [lag], box, bandwidth)
    assert found.theta[lag] == box.lower[lag]
    assert without_unexcited(predictor, Stage(found, bandwidth, [lag], 1), PLANT, box).free == [lag]

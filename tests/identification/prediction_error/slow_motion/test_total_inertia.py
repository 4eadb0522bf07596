"""Total inertia from the slow motion, or from motor and load together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.gain_schedule import Bandwidth, Stage
from lostmotion.identification.prediction_error.identifiability import WIDEST, Told
from lostmotion.identification.prediction_error.innovations import NAMES, Predictor
from lostmotion.identification.prediction_error.slow_motion.total_inertia import (
    SURE,
    of_slow_motion,
    total_inertia,
)
from lostmotion.identification.statistics.block_covariance import student_factor
from lostmotion.identification.statistics.levenberg_marquardt import Fit

DT = 1e-3
RIGID = lm.Drivetrain(inertias=(0.13,), frictions=(lm.Friction(coulomb=(2.4, 1.6), viscous=0.02),))
SOFT = lm.Drivetrain.two_mass(
    inertia_motor=0.02,
    inertia_load=0.11,
    stiffness=450.0,
    damping=0.2,
    backlash=0.01,
    coulomb=1.0,
    viscous=0.02,
)


def predictor(
    plant: lm.Drivetrain,
    seed: int = 1,
    duration: float = 6.0,
    load: np.ndarray | float = 0.0,
    noise: float = 0.02,
    sign: float = 1.0,
    bounds: tuple[int, ...] = (),
) -> Predictor:
    """Torque and noisy speed of a drive under levels and noise."""
    torque = lm.signals.excitation(duration, DT, seed=seed, inertia=0.13, coulomb=2.0, viscous=0.02)
    run = lm.simulate(plant, torque_motor=torque, torque_load=load + 0.0 * torque, dt=DT)
    speed = sign * run["speed_motor"] + noise * np.random.default_rng(seed).standard_normal(torque.size)
    base = SOFT if len(plant.inertias) == 1 else plant
    return Predictor(torque, speed, DT, False, base, skip=0, bounds=bounds or (0, torque.size))


def off(found: tuple[float, float], plant: lm.Drivetrain) -> float:
    return abs(float(np.log(found[0] / plant.inertia_total)))


def slow_load(size: float, duration: float = 6.0) -> np.ndarray:
    return size * np.sin(2.0 * np.pi * 0.3 * DT * np.arange(round(duration / DT)) + 1.0)


def test_of_a_rigid_drive():
    found = of_slow_motion(predictor(RIGID), zero=30.0)
    assert off(found, RIGID) < found[1] < 0.01


def test_frequencies_with_a_slow_load_torque_count_less():
    """As large as the friction; unweighted, the half width is several times as wide."""
    found = of_slow_motion(predictor(RIGID, load=slow_load(2.0)), zero=30.0)
    assert off(found, RIGID) < found[1] < 0.03


def test_at_a_standstill_the_torque_says_nothing():
    """Friction holds it at any level. With these rows the half width was 0.056."""
    whole = lm.signals.excitation(6.0, DT, seed=1, inertia=0.13, coulomb=2.0, viscous=0.02)
    time = DT * np.arange(whole.size)
    torque = np.where(time % 1.5 < 0.75, whole, 1.4 * np.sin(2.0 * np.pi * 2.1 * time))
    run = lm.simulate(RIGID, torque_motor=torque, dt=DT)
    assert np.mean(run["speed_motor"] == 0.0) > 0.1
    speed = run["speed_motor"] + 0.02 * np.random.default_rng(1).standard_normal(torque.size)
    found = of_slow_motion(Predictor(torque, speed, DT, False, SOFT, skip=0), zero=30.0)
    assert off(found, RIGID) < found[1] < 0.01


@pytest.mark.parametrize("factor", [0.4, 1.0, 2.5])
def test_of_an_elastic_drive_with_a_gap_whatever_the_nameplate_says(factor: float):
    """The true zero is at 10 Hz: far above it, the motor turns alone, with a seventh of the inertia."""
    found = of_slow_motion(predictor(SOFT), factor * SOFT.zero_frequency)
    assert off(found, SOFT) < found[1] < 0.0032 * SURE, "without the compliance 0.0036 to 0.0055"


def test_intervals_hold_as_often_as_they_say():
    drives = [(plant, seed) for plant in (RIGID, SOFT) for seed in range(1, 13)]
    found = [
        (of_slow_motion(predictor(plant, seed, load=slow_load(0.2 * seed)), 10.0), plant)
        for plant, seed in drives
    ]
    held = sum(off(one, plant) < one[1] for one, plant in found)
    assert held >= 21, "of 24: by chance fewer once in 100 times"
    assert np.median([one[1] for one, _ in found]) < 0.023 * SURE


def test_pieces_are_transformed_each_for_itself():
    """What is between two pieces is no motion."""
    whole = predictor(RIGID)
    kept = np.r_[0:2500, 3300 : whole.speed.size]
    jump = abs(whole.speed[3300] - whole.speed[2499])
    assert jump > 0.3 * np.std(whole.speed)
    one = Predictor(whole.torque[kept], whole.speed[kept], DT, False, SOFT, skip=0)
    two = replace(one, bounds=(0, 2500, kept.size))
    assert off(of_slow_motion(two, 30.0), RIGID) < of_slow_motion(two, 30.0)[1] < 0.02
    assert of_slow_motion(one, 30.0)[1] > 0.02


def test_a_drive_that_does_not_move_tells_none():
    torque = np.random.default_rng(1).standard_normal(6000)
    still = Predictor(torque, np.zeros(6000), DT, False, SOFT, skip=0)
    assert of_slow_motion(still, 30.0)[1] == np.inf


def test_a_torque_of_the_wrong_sign_tells_none():
    assert of_slow_motion(predictor(RIGID, sign=-1.0), 30.0)[1] == np.inf
    assert total_inertia((np.nan, np.inf), *told(free=[0])) is None


def test_an_inertia_that_is_hardly_known_is_none():
    assert total_inertia((0.1, 0.9 * WIDEST), *told(free=[0])) is not None
    assert total_inertia((0.1, 1.1 * WIDEST), *told(free=[0])) is None


def told(half: float = 0.05, correlation: float = 0.0, free: list[int] | None = None) -> tuple[Stage, Told]:
    """0.03 and 0.1 kg m2, each with this half width, by chance alone."""
    free = [0, 1] if free is None else free
    theta = np.log([0.03, 0.1, *[1.0] * (len(NAMES) - 2)])
    covariance = (half / student_factor(1)) ** 2 * np.array([[1.0, correlation], [correlation, 1.0]])
    fit = Fit(theta, np.zeros(1), 0.0, 1, True)
    stage = Stage(fit, Bandwidth(1.0, 1.0), free, 1)
    return stage, Told(theta, covariance[: len(free), : len(free)], np.full(len(free), half))


def half_of(found: tuple[float, tuple[float, float]] | None) -> float:
    assert found is not None
    return 0.5 * float(np.log(found[1][1] / found[1][0]))


def test_the_sum_of_motor_and_load_if_it_is_known_better():
    found = total_inertia((0.131, 0.1), *told())
    assert found is not None and found[0] == pytest.approx(0.13)
    # Independent: √(0.03² + 0.1²)/0.13 of the half width.
    assert half_of(found) == pytest.approx(0.05 * np.hypot(0.03, 0.1) / 0.13)
    alike, opposite = (half_of(total_inertia((0.131, 0.1), *told(correlation=c))) for c in (1.0, -1.0))
    assert alike == pytest.approx(0.05) and opposite == pytest.approx(0.05 * 0.07 / 0.13)
    assert half_of(total_inertia((np.nan, np.inf), *told())) == pytest.approx(half_of(found))


def test_the_slow_motion_if_it_knows_better_and_room_for_both_where_they_contradict():
    better = total_inertia((0.131, 0.01), *told())
    assert better is not None and better[0] == 0.131 and half_of(better) == pytest.approx(0.01)
    contradicted = total_inertia((0.2, 0.1), *told())
    assert contradicted is not None and contradicted[0] == pytest.approx(0.13)
    assert contradicted[1][0] < 0.13 < 0.2 < contradicted[1][1]
    alone = total_inertia((0.131, 0.2), *told(free=[0]))
    assert alone is not None and alone[0] == 0.131
    assert total_inertia((0.131, 1.2), *told(free=[0])) is None

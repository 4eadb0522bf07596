"""Stiffness and both inertias as states of the filters that track parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rig_runs import relative_rmse, rig_experiment
from table_i import PAPER

from lostmotion.compare.cases import Case
from lostmotion.compare.experiment import experiment as leaderboard_experiment
from lostmotion.compare.scores import SIGNALS, score
from lostmotion.drivetrain import Drivetrain
from lostmotion.kernels.estimators.layout import INVERSE_INERTIA_LOAD, PARAMETERS, STIFFNESS, TRACKED
from lostmotion.kernels.estimators.tracking.prediction import jacobian
from lostmotion.kernels.estimators.tracking.start import bound
from lostmotion.kernels.estimators.two_mass_model import advance
from lostmotion.observers import extended_kalman, moving_horizon, unscented_kalman
from lostmotion.observers.filters.two_mass_parameters import model_parameters, transition
from lostmotion.simulation import simulate

FILTERS = (extended_kalman, unscented_kalman, moving_horizon)
FAST = (extended_kalman, unscented_kalman)
FACTORS = ("stiffness", "inertia_motor", "inertia_load")
DT = 1e-4


def changed(stiffness: float, inertia_motor: float, inertia_load: float) -> Drivetrain:
    return PAPER.with_parameters(
        stiffness=PAPER.stiffness * stiffness, damping=PAPER.damping * stiffness,
        inertia_motor=PAPER.inertia_motor * inertia_motor, inertia_load=PAPER.inertia_load * inertia_load,
    )  # fmt: skip


@pytest.mark.parametrize("factors", [(0.8, 1.0, 1.0), (1.0, 1.25, 1.0), (1.0, 1.0, 0.8), (1.2, 0.8, 1.25)])
@pytest.mark.parametrize("substep", [DT, 2.5e-4])
def test_a_factor_moves_the_model_as_the_changed_matrices_do(factors, substep):
    """Over one substep in contact, at up to 70 Nm and 10 rad/s: RMS of the error far below any sensor's noise."""
    p = model_parameters(PAPER, ("speed_motor",), substep, None, False)
    assert p["substeps"] == 1.0
    exact = transition(changed(*factors), substep)
    rng = np.random.default_rng(1)
    errors = []
    for _ in range(200):
        x = (0.006 + rng.uniform(0.0, 0.01), rng.uniform(-10.0, 10.0), 0.0, 0.0)
        torque, gap = rng.uniform(-70.0, 70.0), 0.006
        moved = advance(
            p[()], np.array(x), 0.0, 0.0, gap, torque, factors[0], 1.0 / factors[1], 1.0 / factors[2]
        )
        errors.append(np.array(moved)[[0, 1, 2, 4]] - (exact @ [*x, torque, gap, 0.0, 0.0])[[0, 1, 2, 4]])
    rms = np.sqrt(np.mean(np.square(errors), axis=0))
    assert np.all(rms < [2e-6, 0.005, 0.005, 2e-6]), rms  # rad, rad/s, rad/s, rad


def test_factors_of_one_change_nothing():
    p = model_parameters(PAPER, ("speed_motor",), DT, None, False)
    x, held = np.array([0.008, 3.0, -2.0, 0.0]), (0.5, 2.0, 0.006, 12.0)
    assert advance(p[()], x, *held) == advance(p[()], x, *held, 1.0, 1.0, 1.0)


def finite_differences(p, x, torque):
    """Of the four moving states and the turn, by the states and the factors."""

    def moved(v):
        gap = float(np.clip(v[0] + p["lead_middle"] * (v[1] - v[2]), -0.5 * v[6], 0.5 * v[6]))
        factors = v[STIFFNESS : INVERSE_INERTIA_LOAD + 1]
        return np.array(advance(p[()], v, v[5], v[7], gap, torque, *factors)[:5])

    steps = 1e-6 * np.eye(x.size)
    return np.array([(moved(x + step) - moved(x - step)) / 2e-6 for step in steps]).T


@pytest.mark.parametrize("speed_load", [-2.0, 0.0])
@pytest.mark.parametrize("twist", [0.009, 0.001, -0.008])
def test_the_derivatives_are_those_of_the_model(twist, speed_load):
    """Above, in and below the gap; load slipping and at rest; motor with friction; a lag."""
    p = model_parameters(
        PAPER.with_parameters(lag=1e-3, coulomb_motor=0.5), ("speed_motor",), DT, None, False
    )
    coulomb = 2.0 if speed_load else 90.0
    x = np.array([twist, 3.0, speed_load, 4.0, 0.0, 0.5, 0.012, coulomb, 0.85, 1.2, 0.9])
    edge = float(np.sign(twist)) if abs(twist) > 0.006 else 0.0
    gap = float(np.clip(x[0] + p["lead_middle"] * (x[1] - x[2]), -0.006, 0.006))
    out = advance(p[()], x, x[5], x[7], gap, 12.0, *x[STIFFNESS:])
    f = np.empty((5, x.size))
    jacobian(p[()], x, gap, 1.0 - abs(edge), edge, (out[1] - x[1], out[2] - x[2]), out[5], out[6], f)
    f[4, 4] = 0.0  # the angle's own, which ``advance`` does not add
    expected = finite_differences(p, x, 12.0)
    for j in range(x.size):
        assert f[:, j] == pytest.approx(expected[:, j], abs=0.02 * np.max(np.abs(expected[:, j])) + 1e-12), j


@pytest.mark.parametrize("make", FILTERS)
@pytest.mark.parametrize("name", FACTORS)
@pytest.mark.parametrize("told", [0.8, 1.2])
def test_finds_a_parameter_20_percent_off(make, name, told):
    """On the rig, from motor torque and speed, within 8 % in 2 s (the mode beyond the model biases both)."""
    rec, _, model = rig_experiment(2, 2.0)
    true = getattr(model, name)
    result = make(model.with_parameters(**{name: told * true}), dt=DT, speed_from_counts=True).run(rec)
    assert result[f"{name}_estimated"][-1] == pytest.approx(true, rel=0.08)
    assert 0.0 < result[f"{name}_deviation"][-1] < 0.02 * true


@pytest.mark.parametrize("make", FAST)
@pytest.mark.parametrize("name", FACTORS)
def test_target_with_a_parameter_20_percent_off(make, name):
    """Load speed, shaft torque and elastic twist within 1.5 % of range after 5 s."""
    for told in (0.8, 1.2):
        data = leaderboard_experiment(Case("off", "", factors={name: told}), 5, 6.0)
        observer = make(data.drivetrain, dt=DT, speed_from_counts=True)
        found = score(observer, replace(data, judged=slice(50000, None)))
        assert max(found[s] for s in SIGNALS) < 0.015, (told, found)


@pytest.mark.parametrize("make", FILTERS)
def test_held_parameters_stay_as_told(make, experiment):
    rec, _, model = experiment
    short = rec.window(0.0, 0.5)
    held = dict.fromkeys(FACTORS, 0.0)
    result = make(model, dt=DT, drift=held, uncertainty=held, speed_from_counts=True).run(short)
    for name in FACTORS:
        assert np.all(result[f"{name}_estimated"] == getattr(model, name))
        assert np.all(result[f"{name}_deviation"] == 0.0)


def test_factors_stay_within_half_and_twice():
    p = np.array(extended_kalman(PAPER, dt=DT).parameters).view(PARAMETERS)[0]
    x = np.ones(TRACKED)
    x[STIFFNESS : INVERSE_INERTIA_LOAD + 1] = 5.0, 0.1, -3.0
    bound(p, x)
    assert x[STIFFNESS : INVERSE_INERTIA_LOAD + 1] == pytest.approx([2.0, 0.5, 0.5])


@pytest.mark.parametrize("make", FILTERS)
def test_a_measured_shaft_torque_tells_the_stiffness(make):
    rng = np.random.default_rng(3)
    torque = 8.0 * np.repeat(rng.normal(size=100), 50) + 3.0
    plant = changed(1.2, 1.0, 1.0)
    true = simulate(plant, dt=DT, torque_motor=torque)
    data = {
        "torque_motor": torque,
        "speed_motor": true["speed_motor"] + 0.03 * rng.normal(size=torque.size),
        "torque_shaft": true["torque_shaft"] + 0.3 * rng.normal(size=torque.size),
    }
    result = make(PAPER, dt=DT, measured=("speed_motor", "torque_shaft")).run(data)
    assert result["stiffness_estimated"][-1] == pytest.approx(plant.stiffness, rel=0.02)
    assert relative_rmse(result, true, "torque_shaft", 2000) < 0.01

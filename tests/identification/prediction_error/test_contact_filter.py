"""Innovations of the contact-switching filter, their likelihood, and descents with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_filter import (
    INDEX,
    NAMES,
    PARAMETERS,
    ContactFilter,
    white_noise,
)
from lostmotion.identification.prediction_error.innovations import Predictor
from lostmotion.identification.prediction_error.likelihood import Box, descend, minimise

DT = 2e-4
PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip
VALUES = {name: value for name, value in PLANT.parameters().items() if name in NAMES}
RATES = {"motor_rate": 30.0, "load_rate": 10.0, "torque_rate": 0.0}
CORE = [INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness", "backlash")]


@pytest.fixture(scope="module", params=[False, True], ids=["noise", "counts"])
def flt(request: pytest.FixtureRequest) -> ContactFilter:
    torque = lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(PLANT, torque_motor=torque, dt=DT)
    if request.param:
        count = 2.0 * np.pi / 2**18
        speed = np.diff(np.floor(run["angle_motor"] / count), prepend=0.0) * count / DT
    else:
        speed = run["speed_motor"] + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
    return ContactFilter.of(Predictor(torque, speed, DT, request.param, PLANT, skip=0), 100.0)


def test_the_true_parameters_leave_the_sensors_noise(flt: ContactFilter):
    run = flt.run(flt.theta(VALUES | RATES))
    assert run.cost == pytest.approx(0.0, abs=0.06)
    # White: neighbours are not correlated.
    w = run.weighted[200:]
    assert abs(np.mean(w[1:] * w[:-1]) / np.mean(w**2)) < 0.1


@pytest.mark.parametrize("name", ["inertia_motor", "stiffness", "backlash", "coulomb"])
def test_wrong_parameters_cost_more(flt: ContactFilter, name: str):
    own = flt.run(flt.theta(VALUES | RATES)).cost
    for factor in (0.8, 1.25):
        assert flt.run(flt.theta(VALUES | RATES | {name: factor * VALUES[name]})).cost > own + 1e-3


def test_sensitivities_lead_back_to_the_truth(flt: ContactFilter):
    truth = flt.theta(VALUES | RATES)
    theta = truth.copy()
    theta[CORE] += (0.05, -0.05, 0.05, -0.05)
    found, run = minimise(flt, theta, CORE, Box.around(flt, truth, 10.0), 10)
    assert np.max(np.abs(found[CORE] - truth[CORE])) < 5e-3
    assert run.cost < flt.run(theta).cost


def test_a_descent_finds_the_truth_from_far_off(flt: ContactFilter):
    """From twice the stiffness and half the gap, by ever lower noise levels."""
    truth = flt.theta(VALUES | RATES)
    theta = truth.copy()
    theta[CORE] += np.log([1.3, 0.8, 2.0, 0.5])
    found = descend("far", flt, theta, CORE, Box.around(flt, truth, 10.0))
    assert np.max(np.abs(found.theta[CORE] - truth[CORE])) < 0.01
    assert found.cost < 0.06


def test_costs_under_different_noise_levels_compare(flt: ContactFilter):
    """A filter that counts on ten times the noise predicts no better: its cost says so, by a likelihood."""
    theta = flt.theta(VALUES | RATES)
    assert flt.run(theta).cost < replace(flt, level=10.0 * flt.floor).run(theta).cost


def test_the_filter_starts_anew_with_each_piece(flt: ContactFilter):
    theta, middle = flt.theta(VALUES | RATES), flt.rows // 2
    two = replace(flt, bounds=(0, middle, flt.rows))
    alone = flt.part(slice(middle, flt.rows))
    # The start's own spread depends on the recording's torque, so only the first moments differ.
    assert two.run(theta).weighted[middle + 500 :] == pytest.approx(alone.run(theta).weighted[500:], abs=0.05)


def test_values_survive_the_parameter_vector(flt: ContactFilter):
    values = {name: 0.1 * (i + 1.0) for i, name in enumerate(PARAMETERS)}
    assert flt.values(flt.theta(values)) == pytest.approx(list(values.values()))


def test_noise_of_a_smooth_signal_is_seen():
    time = np.arange(20_000) * 1e-4
    noise = 1e-3 * np.random.default_rng(3).standard_normal(time.size)
    assert white_noise(10.0 * np.sin(30.0 * time) + noise) == pytest.approx(1e-3, rel=0.05)

"""Rows that count: a standstill predicts itself, and hides how poorly the rest is predicted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.counting_rows import counting_rows
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.innovations import Predictor

DT = 2e-4


@pytest.fixture(params=[False, True], ids=["noise", "counts"])
def pausing(request: pytest.FixtureRequest, plant: lm.Drivetrain) -> tuple[ContactFilter, np.ndarray]:
    """A filter over a second that moves and one at a standstill, twice; and where the torque is zero."""
    noise = lm.signals.noise(4.0, 100.0, 4.0, 4.0, DT, seed=3)
    time = np.arange(noise.size) * DT
    pause = time % 2.0 >= 1.0
    torque = np.where(pause, 0.0, 10.0 * np.sin(6.0 * np.pi * time) + noise)
    plant = replace(
        plant, frictions=(lm.Friction(0.5), plant.frictions[1])
    )  # else the motor drifts in the gap
    run = lm.simulate(plant, torque_motor=torque, dt=DT)
    if request.param:
        count = 2.0 * np.pi / 2**16
        speed = np.diff(np.floor(run["angle_motor"] / count), prepend=0.0) * count / DT
    else:
        speed = run["speed_motor"] + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
    predictor = Predictor(torque, speed, DT, request.param, plant, skip=0)
    return ContactFilter.of(predictor, 3.0 * plant.pole_frequency), pause


def test_a_standstill_does_not_count(pausing: tuple[ContactFilter, np.ndarray], values: dict[str, float]):
    flt, pause = pausing
    rests = np.ones(flt.rows, dtype=bool)
    rests[flt.counting] = False
    assert np.mean(rests[pause]) > 0.3  # until it has come to rest, the rows count
    assert np.mean(rests[flt.settling :][~pause[flt.settling :]]) < 0.1

    every = replace(flt, settling=0)
    wrong = flt.theta(values | {"coulomb_motor": 0.5, "stiffness": 1.3 * values["stiffness"]})
    assert flt.run(wrong).cost > every.run(wrong).cost + 0.3
    right = flt.theta(values | {"coulomb_motor": 0.5, "motor_rate": 30.0, "load_rate": 30.0})
    assert abs(flt.run(right).cost) < 0.1
    if flt.counted:  # the rounding of a standstill is no noise
        assert every.run(right).cost < -0.1


def test_where_all_stands_still_all_counts():
    assert counting_rows(np.zeros(500), True, 1e-3, (0, 500), 90).size == 375
    assert counting_rows(np.zeros(500), True, 1e-3, (0, 500), 0).size == 500

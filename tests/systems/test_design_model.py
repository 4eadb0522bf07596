"""The sampled design model against the simulation, and the steady state against itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.drivetrain import Friction
from lostmotion.errors import InvalidInput
from lostmotion.simulation import simulate
from lostmotion.systems import design_model, steady_state

PLANT = PAPER.with_parameters(backlash=0.0, coulomb=0.0, viscous_motor=0.004, lag=3e-4)
DT = 1e-4


@pytest.mark.parametrize("delay", [0, 1, 3])
@pytest.mark.parametrize("lag", [0.0, 3e-4])
def test_it_steps_as_the_simulation_does(delay, lag):
    plant = PLANT.with_parameters(lag=lag)
    model = design_model(plant, DT, delay)
    rng = np.random.default_rng(3)
    torque, load = 20.0 * rng.normal(size=400), 5.0 * rng.normal(size=400)
    acting = np.concatenate([np.zeros(delay), torque])[: torque.size]
    true = simulate(plant, dt=DT, torque_motor=acting, torque_load=load)
    x = np.zeros(len(model.states))
    found = np.empty((torque.size, 3))
    for k in range(torque.size):
        found[k] = x[:3]
        x = model.A @ x + model.B * torque[k] + model.E * load[k]
    for i, name in enumerate(("twist", "speed_motor", "speed_load")):
        np.testing.assert_allclose(found[:, i], true[name], rtol=0.0, atol=1e-10 * np.ptp(true[name]))


def test_names_and_rows():
    model = design_model(PLANT, DT)
    assert model.states == ("twist", "speed_motor", "speed_load", "torque_actuator", "torque_last")
    np.testing.assert_array_equal(model.row(speed_motor=1.0, torque_last=-2.0), [0.0, 1.0, 0.0, 0.0, -2.0])
    assert design_model(PLANT.with_parameters(lag=0.0), DT, 2).states[3:] == (
        "torque_last_1",
        "torque_last_2",
    )


@pytest.mark.parametrize("speed, torque_load", [(3.0, 0.0), (-2.0, 7.0), (0.5, -10.0)])
def test_the_steady_state_stays_in_the_simulation(speed, torque_load):
    frictions = (Friction((0.4, 0.6), 0.004), Friction(2.0, 0.0175, stribeck=((0.0, 0.3), (2.0, 0.0))))
    plant = replace(PLANT.with_parameters(lag=0.0), frictions=frictions)
    held = steady_state(plant, design_model(plant, DT), speed, torque_load)
    n = 300
    run = simulate(
        plant, dt=DT, torque_motor=np.full(n, held.torque), torque_load=np.full(n, torque_load),
        state=tuple(held.state[:3]),
    )  # fmt: skip
    for i, name in enumerate(("twist", "speed_motor", "speed_load")):
        np.testing.assert_allclose(run[name], held.state[i], rtol=0.0, atol=1e-11)


def test_the_steady_state_is_a_fixed_point_of_the_model_with_its_torques():
    plant, load = PLANT.with_parameters(coulomb=2.0), 7.0
    model = design_model(plant, DT)
    held = steady_state(plant, model, -3.0, load)
    x = model.A @ held.state + model.B * held.torque + model.E * (load + 2.0)
    np.testing.assert_allclose(x, held.state, rtol=1e-12)


@pytest.mark.parametrize("delay", [-1, 0.5])
def test_delays_that_are_none(delay):
    with pytest.raises(InvalidInput, match=r"design_model\.delay"):
        design_model(PLANT, DT, delay)

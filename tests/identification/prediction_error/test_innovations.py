"""The kernel's innovations are those of the project's own observer."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.identification.prediction_error.innovations import (
    NAMES,
    Bandwidth,
    Predictor,
    from_theta,
    to_theta,
)
from lostmotion.systems import DiscreteSystem

DT = 1e-4
BASE = PAPER.with_parameters(coulomb_motor=0.3, viscous_motor=0.01)


def signals(n: int = 4000) -> tuple[np.ndarray, np.ndarray]:
    torque = lm.signals.noise(1.0, 120.0, 12.0, n * DT, DT, seed=4)
    speed = lm.simulate(BASE, torque_motor=torque, dt=DT)["speed_motor"]
    return torque, speed + 0.05 * np.random.default_rng(2).standard_normal(n)


def by_hand(system: DiscreteSystem, torque: np.ndarray, speed: np.ndarray, averaged: bool) -> np.ndarray:
    """Innovations from the matrices of the DiscreteSystem alone."""
    start = {"speed_motor": speed[0], "speed_load": speed[0], "torque_actuator": torque[0]}
    start["speed_motor_previous"] = speed[0]
    x = np.array([start.get(name, 0.0) for name in system.states])
    weight = {"speed_motor": 0.5, "speed_motor_previous": 0.5} if averaged else {"speed_motor": 1.0}
    measured = np.array([weight.get(name, 0.0) for name in system.states])
    residual = np.empty(torque.size)
    for i, u in enumerate(np.column_stack([torque, speed])):
        w = np.zeros(len(system.curves))
        for j, curve in enumerate(system.curves):
            w[j] = curve(system.F[j] @ x + system.G[j] @ u + system.H[j] @ w)
        residual[i] = u[1] - measured @ x
        x = system.A @ x + system.B @ u + system.E @ w
    return residual


@pytest.mark.parametrize("averaged", [True, False])
@pytest.mark.parametrize("lag", [3e-4, 1e-5, 0.0])
@pytest.mark.parametrize(
    "changes", [{}, {"coulomb_motor": 0.0}, {"backlash": 0.0}, {"coulomb": 0.0, "damping": 0.0}]
)
def test_innovations_are_those_of_the_kalman_observer(averaged: bool, lag: float, changes: dict[str, float]):
    torque, speed = signals()
    base = BASE.with_parameters(lag=lag, **changes)
    predictor = Predictor(torque, speed, DT, averaged, base, skip=0)
    theta = to_theta([getattr(base, n) for n in NAMES], DT)
    bandwidth = Bandwidth(550.0, 27.0)
    residual = predictor.residual(theta, bandwidth)
    expected = by_hand(predictor.observer(theta, bandwidth), torque, speed, averaged)
    assert np.max(np.abs(residual - expected)) < 1e-9
    assert np.std(residual) > 0.04


def test_two_threads_give_the_same_rows():
    torque, speed = signals()
    predictor = Predictor(torque, speed, DT, False, BASE, skip=10)
    theta = to_theta([getattr(BASE, n) for n in NAMES], DT)
    thetas = theta + 0.1 * np.eye(theta.size)[[0, 2, 4]]
    together = predictor.residuals(thetas, Bandwidth(550.0, 27.0))
    alone = [predictor.residual(t, Bandwidth(550.0, 27.0)) for t in thetas]
    assert np.array_equal(together, alone)
    assert not together[:, :10].any() and together[:, 10].all()


def test_theta_and_back():
    values = [0.02, 0.1, 6000.0, 0.4, 0.01, 0.0, 0.02, 0.0]
    assert from_theta(to_theta(values, DT), DT) == pytest.approx(values, rel=1e-12, abs=1e-15)

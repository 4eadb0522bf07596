"""A recording of an exact drive, as the contact-switching filter takes it, and the drive's parameters."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import NAMES, ContactFilter
from lostmotion.identification.prediction_error.innovations import Predictor

DT = 2e-4
PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip


@pytest.fixture(scope="session")
def plant() -> lm.Drivetrain:
    return PLANT


@pytest.fixture(scope="session")
def values() -> dict[str, float]:
    """True parameters, and the rates of the filter's unknown torques."""
    true = {name: value for name, value in PLANT.parameters().items() if name in NAMES}
    return true | {"motor_rate": 30.0, "load_rate": 10.0, "torque_rate": 0.0}


@pytest.fixture(scope="session", params=[False, True], ids=["noise", "counts"])
def flt(request: pytest.FixtureRequest) -> ContactFilter:
    torque = lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(PLANT, torque_motor=torque, dt=DT)
    if request.param:
        count = 2.0 * np.pi / 2**18
        speed = np.diff(np.floor(run["angle_motor"] / count), prepend=0.0) * count / DT
    else:
        speed = run["speed_motor"] + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
    return ContactFilter.of(Predictor(torque, speed, DT, request.param, PLANT, skip=0), 300.0)

"""The noise of the motor's sensor, also where there is none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.innovations import Predictor


def test_a_speed_without_noise_gets_some(plant: lm.Drivetrain, values: dict[str, float]):
    """The same at each call; one that never changes is refused."""
    torque = lm.signals.excitation(1.0, 2e-4, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    speed = lm.simulate(plant, torque_motor=torque, dt=2e-4)["speed_motor"]
    exact = Predictor(torque, speed, 2e-4, False, plant, skip=0)
    one, other = ContactFilter.of(exact, 300.0), ContactFilter.of(exact, 300.0)
    assert one.floor == pytest.approx(1e-4 * np.std(speed)) and np.array_equal(one.measured, other.measured)
    assert np.std(one.measured - speed) == pytest.approx(one.floor, rel=0.05)
    assert one.run(one.theta(values)).cost == pytest.approx(0.0, abs=0.06)
    with pytest.raises(lm.LostMotionError, match="speed_motor"):
        ContactFilter.of(replace(exact, speed=np.full(speed.size, 3.0)), 300.0)

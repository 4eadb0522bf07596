"""Sensitivity and torque noise of a sampled speed loop."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion.controllers import pi
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.simulation import simulate
from lostmotion.systems import design_model, loop_margin

DT = 1e-4
PLANT = Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.4, lag=3e-4)


def diverges(kp: float) -> bool:
    reference = np.where(np.arange(4000) < 10, 0.0, 1.0)
    run = simulate(PLANT, dt=DT, law=pi(dt=DT, kp=kp, ki=20.0 * kp), delay=1, speed_reference=reference)
    return bool(np.max(np.abs(run["speed_motor"][2000:])) > 10.0)


@pytest.mark.parametrize("kp", [2.0, 10.0, 60.0, 90.0])
def test_it_is_infinite_exactly_where_the_simulated_loop_diverges(kp):
    margin = loop_margin(pi(dt=DT, kp=kp, ki=20.0 * kp), design_model(PLANT, DT))
    assert math.isinf(margin.sensitivity) == math.isinf(margin.torque_per_speed_noise) == diverges(kp)


def test_the_inverse_is_the_gain_that_is_left():
    """Of a loop whose Nyquist curve comes nearest to −1 on the axis, 1/S is one minus the gain: here S bounds it."""
    model = design_model(PLANT, DT)
    margin = loop_margin(pi(dt=DT, kp=10.0, ki=200.0), model).sensitivity
    allowed = margin / (margin - 1.0)
    louder = loop_margin(pi(dt=DT, kp=0.99 * allowed * 10.0, ki=0.99 * allowed * 200.0), model)
    assert math.isfinite(louder.sensitivity)
    assert louder.sensitivity > margin


def test_torque_noise_as_in_simulation():
    law, n = pi(dt=DT, kp=10.0, ki=200.0), 40_000
    expected = loop_margin(law, design_model(PLANT, DT)).torque_per_speed_noise
    noise = 0.01 * np.random.default_rng(1).standard_normal(n)
    run = simulate(PLANT, dt=DT, law=law, delay=1, speed_reference=noise)
    # Noise on the set-point acts as the noise of the sensor does, with the other sign.
    assert float(np.std(run["torque_motor"][2000:])) / 0.01 == pytest.approx(expected, rel=0.05)


def test_counts_are_late_by_half_a_sample():
    law, model = pi(dt=DT, kp=30.0, ki=600.0), design_model(PLANT, DT)
    assert loop_margin(law, model, True).sensitivity > loop_margin(law, model, False).sensitivity


def test_a_law_with_curves_is_refused():
    with pytest.raises(InvalidInput, match="linearised"):
        loop_margin(pi(dt=DT, torque_limit=10.0), design_model(PLANT, DT))

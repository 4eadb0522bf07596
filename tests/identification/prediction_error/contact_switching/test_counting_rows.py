"""Rows that count: a standstill predicts itself, and hides how poorly the rest is predicted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.counting_rows import counting_rows
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter

DT = 2e-4


@pytest.mark.parametrize("bits", [None, 16], ids=["noise", "counts"])
def test_a_standstill_does_not_count(
    bits: int | None,
    plant: lm.Drivetrain,
    values: dict[str, float],
    seen: Callable[[lm.Drivetrain, np.ndarray, int | None, float], ContactFilter],
):
    """A second that moves and one at a standstill, twice; friction at the motor, else it drifts in the gap."""
    noise = lm.signals.noise(4.0, 100.0, 4.0, 4.0, DT, seed=3)
    time = np.arange(noise.size) * DT
    pause = time % 2.0 >= 1.0
    torque = np.where(pause, 0.0, 10.0 * np.sin(6.0 * np.pi * time) + noise)
    rubbing = replace(plant, frictions=(lm.Friction(0.5), plant.frictions[1]))
    flt = seen(rubbing, torque, bits, 3.0 * plant.pole_frequency)
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

"""Rows that count: counts at a standstill predict themselves, and hide how poorly the rest is predicted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.sensor.counting_rows import counting_rows

DT = 2e-4


def test_counts_at_a_standstill_do_not_count(
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
    flt, analog = (seen(rubbing, torque, bits, 3.0 * plant.pole_frequency) for bits in (16, None))
    rests = np.ones(flt.rows, dtype=bool)
    rests[flt.counting] = False
    assert np.mean(rests[pause]) > 0.3  # until it has come to rest, the rows count
    assert np.mean(rests[flt.settling :][~pause[flt.settling :]]) < 0.1
    assert np.array_equal(analog.counting, np.arange(analog.counting[0], analog.rows))  # its noise goes on

    every = replace(flt, settling=0)
    wrong = flt.theta(values | {"coulomb_motor": 0.5, "stiffness": 1.3 * values["stiffness"]})
    assert flt.run(wrong).cost > every.run(wrong).cost + 0.3
    right = flt.theta(values | {"coulomb_motor": 0.5})
    assert 0.0 <= every.run(right).cost < flt.run(right).cost < 0.1
    # A filter that counts on more noise is judged by the same: as Gaussian noise, such rows cost less than nothing.
    louder = replace(every, level=2.6 * every.floor)
    assert replace(louder, rounded=False).run(right).cost < -0.1 < 0.0 <= louder.run(right).cost < 0.1


def test_where_all_stands_still_the_rows_count():
    assert counting_rows(np.zeros(500), True, 1e-3, (0, 500), 90).size == 375
    assert counting_rows(np.zeros(500), True, 1e-3, (0, 500), 0).size == 500

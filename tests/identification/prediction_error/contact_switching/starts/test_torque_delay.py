"""The delay of a commanded torque in a closed loop, where a frequency response does not show it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.starts.frequency_response import (
    linear_drive,
)
from lostmotion.identification.prediction_error.contact_switching.starts.torque_delay import torque_delay
from lostmotion.identification.prediction_error.innovations import Predictor

DT, DELAY, LONGEST = 5e-4, 8, 0.02


@pytest.fixture(scope="module")
def closed_loop(plant: lm.Drivetrain) -> ContactFilter:
    """A speed loop in 22 bit whose torque acts 4 ms, 0.4 of a torsional period, after its row."""
    rng = np.random.default_rng(2)
    law = lm.controllers.pi(dt=DT, kp=0.3, ki=2.0, torque_limit=73.5)
    reference = 5.0 * np.sign(rng.standard_normal(400)).repeat(10)
    run = lm.simulate(plant, dt=DT, law=[law], delay=DELAY, speed_reference=reference)
    count = 2.0 * np.pi / 2**22
    speed = np.diff(np.floor(run["angle_motor"] / count), prepend=0.0) * count / DT
    command = run["torque_motor"][DELAY:]
    return ContactFilter.of(Predictor(command, speed[:-DELAY], DT, True, plant, skip=0), 300.0)


def test_the_delay_of_a_closed_loop_is_found(closed_loop: ContactFilter, plant: lm.Drivetrain):
    """Within a quarter of a torsional period, with a nameplate twice too stiff as well; with the lag of 0.3 ms."""
    true, period = DELAY * DT + plant.lag, 1.0 / plant.pole_frequency
    for pole in (plant.pole_frequency, 1.4 * plant.pole_frequency):
        found = torque_delay(closed_loop, pole, LONGEST)
        assert found == pytest.approx(true, abs=0.25 * period)
    assert abs(linear_drive(closed_loop, plant).get("delay", 0.0) - true) > 0.25 * period


def test_without_a_delay_there_is_none(flt: ContactFilter, plant: lm.Drivetrain):
    found = torque_delay(flt, plant.pole_frequency, LONGEST)
    assert found is None or found < 0.25 / plant.pole_frequency


def test_too_few_rows_tell_nothing(closed_loop: ContactFilter, plant: lm.Drivetrain):
    few = closed_loop.part(slice(0, 150))
    assert torque_delay(few, plant.pole_frequency, LONGEST) is None


def test_the_longest_segment_counts(closed_loop: ContactFilter, plant: lm.Drivetrain):
    whole = torque_delay(closed_loop, plant.pole_frequency, LONGEST)
    two = replace(
        closed_loop,
        torque=np.r_[-closed_loop.torque[:100], closed_loop.torque],
        measured=np.r_[closed_loop.measured[:100], closed_loop.measured],
        bounds=(0, 100, 100 + closed_loop.rows),
    )
    assert torque_delay(two, plant.pole_frequency, LONGEST) == whole

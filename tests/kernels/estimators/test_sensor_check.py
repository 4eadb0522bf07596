"""The verdicts of an estimator's check on samples, one by one."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit
from table_i import PAPER

from lostmotion.kernels.estimators.layout import PARAMETERS, SENSOR_MEMORY
from lostmotion.kernels.estimators.records import reads
from lostmotion.kernels.estimators.sensor_check import check_sample
from lostmotion.kernels.estimators.sensors import sensor_variance
from lostmotion.kernels.estimators.verdicts import FROZEN, JUMP, MISSING, START_AGAIN, USE
from lostmotion.observers import extended_kalman
from lostmotion.observers.filters.two_mass_parameters import FROZEN_HOLD
from lostmotion.systems.input_check import HOLD

DT = 1e-3
NOISE = 0.03
P = np.array(extended_kalman(PAPER, dt=DT, sensor_noise={"speed_motor": NOISE}).parameters)

_parameters, _memory = reads(PARAMETERS), reads(SENSOR_MEMORY)


@njit
def _check(p, memory, value, missing, moved, innovation, variance):
    return check_sample(_parameters(p), 0, _memory(memory), value, missing, moved, innovation, variance)


@njit
def _variance(p, memory):
    return sensor_variance(_parameters(p), 0, _memory(memory))


class Sensor:
    """A sensor of the motor's speed that has shown some values, rad/s."""

    def __init__(self, *shown: float) -> None:
        self.memory = np.zeros(len(SENSOR_MEMORY.names))
        for value in shown or (0.99, 1.0):
            self.verdict(value)

    def verdict(
        self, value: float, moved: float = 0.0, innovation: float = 0.0, missing: bool = False
    ) -> int:
        return _check(P, self.memory, value, missing, moved, innovation, NOISE**2)

    def __getitem__(self, name: str) -> float:
        return float(self.memory.view(SENSOR_MEMORY)[0][name])


def test_a_sample_within_the_gate_is_used():
    """The gate is four deviations and 0.75 rad/s, scaled for the drivetrain."""
    limit = 4.0 * NOISE + P.view(PARAMETERS)[0]["mismatch"][0]
    assert Sensor().verdict(1.1, innovation=0.99 * limit) == USE
    assert Sensor().verdict(1.1, innovation=-1.01 * limit) == JUMP


def test_a_missing_sample_moves_the_model_on():
    sensor = Sensor()
    assert sensor.verdict(np.nan, moved=0.5, missing=True) == MISSING
    assert (sensor["value"], sensor["moved"]) == (1.0, 0.5)


def test_jumps_are_refused_for_the_hold_time_then_the_signal_is_right():
    sensor, hold = Sensor(), round(HOLD / DT)
    verdicts = [sensor.verdict(10.0 + 0.1 * k, innovation=9.0) for k in range(hold + 1)]
    assert verdicts == [JUMP] * hold + [START_AGAIN]
    assert sensor["refused"] == 0.0


def test_a_value_that_comes_again_is_frozen_once_the_model_has_moved():
    """By six deviations, and from the third time on."""
    sensor = Sensor()
    assert sensor.verdict(1.0, moved=7.0 * NOISE) == USE
    assert sensor.verdict(1.0) == FROZEN
    standing = Sensor()
    assert [standing.verdict(1.0, moved=1.0 * NOISE) for _ in range(5)] == [USE] * 5


def test_a_frozen_value_stays_so_where_the_estimate_passes_it_again_until_its_hold_time_is_over():
    sensor = Sensor()
    verdicts = [sensor.verdict(1.0, moved=0.5 if k < 2 else -0.05) for k in range(round(FROZEN_HOLD / DT))]
    assert verdicts == [USE] + [FROZEN] * (len(verdicts) - 2) + [START_AGAIN]
    assert sensor.verdict(1.2) == USE


@pytest.mark.parametrize("step", [1.0, 0.25])
def test_a_coarse_sensor_shows_its_resolution(step):
    fine, coarse = Sensor(), Sensor(5.0, 5.0 + step, 5.0, 5.0 + 3.0 * step)
    assert coarse["resolution"] == pytest.approx(step)
    assert _variance(P, coarse.memory) == pytest.approx(step**2 / 12.0)
    assert _variance(P, fine.memory) == pytest.approx(NOISE**2)

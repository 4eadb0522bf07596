"""Replicas: what the observer's sampling and the sensor shift, and when they cannot be made."""

from __future__ import annotations

import numpy as np
import pytest
from lagged_drive import DT, PLANT, THETA, speed_from_counts

import lostmotion as lm
from lostmotion.identification.prediction_error.bootstrap import REPLICAS, replicas
from lostmotion.identification.prediction_error.gain_schedule import LADDER, Box, Stage, bandwidth_for, fit
from lostmotion.identification.prediction_error.identifiability import without_shift
from lostmotion.identification.prediction_error.innovations import NAMES, Predictor

BOX = Box.around(THETA, DT)


def fitted(count: float | None, load: float = 0.0) -> tuple[Predictor, Stage]:
    """A fit of a recording of 4 s, with or without encoder counts (rad)."""
    torque = lm.signals.excitation(4.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(
        PLANT, torque_motor=torque, torque_load=load * np.sin(np.arange(torque.size) * DT), dt=DT
    )
    speed = run["speed_motor"]
    if count is not None:
        speed = speed_from_counts(run, count)
    predictor = Predictor(torque, speed, DT, count is not None, PLANT, skip=1000, skip_later=4000)
    bandwidth, free = bandwidth_for(PLANT, LADDER[-1]), list(range(len(NAMES)))
    found = fit(predictor, THETA, free, BOX, bandwidth)
    return predictor, Stage(found, bandwidth, free, found.iterations)


@pytest.mark.parametrize("count", [None, 2.0 * np.pi / 2**16])
def test_the_shift_is_taken_off(count: float | None):
    """By the sampling 0.14 % of the motor inertia; by counts of 16 bit 1 % of the damping."""
    predictor, stage = fitted(count)
    names = ("inertia_motor", "stiffness") if count is None else ("damping",)
    rows = [NAMES.index(name) for name in names]
    before = np.abs(stage.fit.theta - THETA)[rows]
    after = np.abs(without_shift(stage, replicas(predictor, stage, BOX)) - THETA)[rows]
    assert np.all(before > 9e-4) and np.all(after < 0.5 * before)


def test_no_replica_of_a_motion_that_it_does_not_follow():
    """A load torque that the model does not have carries the simulated speed away."""
    predictor, stage = fitted(None, load=5.0)
    assert replicas(predictor, stage, BOX) == []
    assert np.array_equal(without_shift(stage, []), stage.fit.theta)


def test_a_replica_has_the_counts_of_the_recording():
    step = 2.0 * np.pi / 2**16 / DT
    predictor, stage = fitted(step * DT)
    made = replicas(predictor, stage, BOX)
    assert len(made) == REPLICAS
    for replica in made:
        counts = replica.predictor.speed / step
        assert np.max(np.abs(counts - np.round(counts))) < 1e-6
        assert not np.array_equal(replica.predictor.speed, predictor.speed)

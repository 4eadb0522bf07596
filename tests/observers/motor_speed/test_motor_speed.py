"""Sliding-mode, super-twisting and intelligent observer: fixed or learning corrections from the motor speed alone."""

from __future__ import annotations

import numpy as np
import pytest
from rig_runs import gap_f1, relative_rmse
from table_i import PAPER

from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman, neural_network, sliding_mode, super_twisting
from lostmotion.observers.motor_speed.parameters import load_corrections
from lostmotion.simulation import simulate

DT = 1e-4


@pytest.mark.parametrize("make", [sliding_mode, super_twisting, neural_network])
def test_estimates_the_rig(make, experiment):
    result = make(experiment.drivetrain, dt=DT, speed_from_counts=True).run(experiment.recording)
    assert relative_rmse(result, experiment.exact, "speed_load") < 0.002
    assert relative_rmse(result, experiment.exact, "torque_shaft") < 0.015
    in_gap = result["twist_elastic_estimated"] == 0.0
    assert gap_f1(in_gap, experiment.exact, experiment.drivetrain.backlash) > 0.9


@pytest.mark.parametrize("make", [sliding_mode, super_twisting])
def test_stands_wrong_friction_better_than_observer_1(make, experiment):
    wrong = experiment.drivetrain.with_parameters(coulomb=0.5 * experiment.drivetrain.coulomb)
    first = kalman(wrong, dt=DT, speed_from_counts=True).run(experiment.recording)
    result = make(wrong, dt=DT, speed_from_counts=True).run(experiment.recording)
    errors = [relative_rmse(r, experiment.exact, "speed_load") for r in (result, first)]
    assert errors[0] < 0.5 * errors[1]


@pytest.mark.parametrize("ratio", [0.3, 0.7, 1.0])
def test_the_corrections_place_the_poles_of_the_load(ratio):
    """Twist and load speed with the motor speed followed: eigenvalues are the roots of s² + 2ζω s + ω²."""
    omega, k, jm, jl = 250.0, PAPER.stiffness, PAPER.inertia_motor, PAPER.inertia_load
    twist, load = load_corrections(PAPER, omega, ratio)
    error = np.array([[twist * k / jm, -1.0], [k / jl + load * k / jm, 0.0]])
    assert np.poly(error) == pytest.approx([1.0, 2.0 * ratio * omega, omega**2], rel=1e-12)


def test_super_twisting_finds_the_torque_that_the_model_misses():
    """3 Nm of unmodelled torque on the motor, found within 20 ms, in the mean to 15 %."""
    n = 5000
    torque = np.full(n, 8.0)
    missed = np.where(np.arange(n) > 2500, 3.0, 0.0)
    true = simulate(PAPER, dt=DT, torque_motor=torque + missed)
    rng = np.random.default_rng(1)
    speed = true["speed_motor"] + 0.005 * rng.normal(size=n)
    stepper = super_twisting(PAPER, dt=DT, sensor_noise=0.005)
    found = stepper.run({"torque_motor": torque, "speed_motor": speed})["torque_unknown_estimated"]
    assert abs(np.mean(found[2000:2500])) < 0.3
    assert np.mean(found[2700:]) == pytest.approx(3.0, rel=0.15)


def test_sliding_mode_holds_the_motor_speed_within_the_layer():
    """Up to the torque that it can overcome, the innovation stays inside the layer."""
    n = 5000
    true = simulate(PAPER, dt=DT, torque_motor=np.full(n, 8.0 + 4.0))
    stepper = sliding_mode(PAPER, dt=DT, unknown_torque=10.0, layer=0.2)
    result = stepper.run({"torque_motor": np.full(n, 8.0), "speed_motor": true["speed_motor"]})
    innovation = true["speed_motor"] - result["speed_motor_estimated"]
    assert np.max(np.abs(innovation[500:])) < 0.2


@pytest.mark.parametrize(("wrong", "gain"), [({"coulomb": 0.5}, 0.4), ({"backlash": 0.5}, 0.35)])
def test_the_networks_learn_what_the_model_misses(wrong, gain, experiment):
    """In the third second the error is a fraction of that of Observer 1, which has the same gain and learns nothing."""
    start = experiment.drivetrain
    start = start.with_parameters(**{name: f * getattr(start, name) for name, f in wrong.items()})
    learned = neural_network(start, dt=DT, learning_time=1.0, speed_from_counts=True).run(
        experiment.recording
    )
    first = kalman(start, dt=DT, speed_from_counts=True).run(experiment.recording)
    errors = [relative_rmse(r, experiment.exact, "speed_load", 20000) for r in (learned, first)]
    assert errors[0] < gain * errors[1]
    if "backlash" in wrong:
        found = np.mean(learned["backlash_estimated"][-10000:])
        assert found == pytest.approx(experiment.drivetrain.backlash, rel=0.1)


@pytest.mark.parametrize("make", [sliding_mode, super_twisting, neural_network])
def test_misuse_is_refused(make):
    argument = {
        sliding_mode: "unknown_torque",
        super_twisting: "torque_rate",
        neural_network: "friction_error",
    }[make]
    with pytest.raises(InvalidInput, match=argument):
        make(PAPER, dt=DT, **{argument: -1.0})
    with pytest.raises(InvalidInput, match="sensor_noise"):
        make(PAPER, dt=DT, sensor_noise=0.0)

"""What a recording does not tell of the torques makes the Cramér–Rao bound wider, by as much as it should."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.rig import Drive, cramer_rao, drive
from lostmotion.rig.zoo.unknown_torque import Whitening, load_changes, torque_noise

#: A command; a measured torque with noise, sensed by angle and by speed; a slow load torque.
COMMANDED, MEASURED, MEASURED_SPEED, SLOW = 3, 23, 51, 42


def closed(one: Drive) -> Drive:
    """The drive without gaps and Coulomb friction, whose torque error's answer is linear."""
    chain = one.truth.drivetrain
    plain = replace(
        chain,
        shafts=tuple(replace(shaft, backlash=0.0) for shaft in chain.shafts),
        frictions=tuple(lm.Friction(viscous=friction.viscous) for friction in chain.frictions),
        actuator=lm.Actuator(),
    )
    return replace(one, truth=replace(one.truth, drivetrain=plain))


def test_a_command_is_known_and_a_measured_torque_is_not():
    assert torque_noise(drive(COMMANDED)) == 0.0
    one = drive(MEASURED)
    quiet = replace(
        one,
        recording=one.recording.with_signals("again", torque_motor=exact_torque(one)),
    )
    # What is left is how the torque goes between rows.
    assert 0.0 < torque_noise(quiet) < torque_noise(one)


def exact_torque(one: Drive) -> np.ndarray:
    from lostmotion.rig.zoo.drive import actual_torque

    lag = one.truth.drivetrain.actuator.lag
    return actual_torque(one.motion, lag)[:: one.motion.steps][: len(one.recording)]


@pytest.mark.parametrize("seed", [MEASURED, MEASURED_SPEED])
def test_whitened_columns_have_the_information_that_the_noise_leaves(seed: int):
    """With the whole covariance of the noise, from simulated answers to a torque in each row: columnsᵀ·R⁻¹·columns."""
    one, rows, sensor_noise = closed(drive(seed)), 200, 1e-4
    dt, steps = one.motion.dt, one.motion.steps
    pulse = np.zeros(rows * steps)
    pulse[:steps] = 1.0
    answer = lm.simulate(one.truth.drivetrain, dt=dt / steps, torque_motor=pulse)[one.sensor.source][::steps]
    answers = np.array([np.r_[np.zeros(k), answer[: rows - k]] for k in range(rows)]).T
    sensor_noise *= float(np.max(np.abs(answer))) * torque_noise(one)
    covariance = torque_noise(one) ** 2 * answers @ answers.T + sensor_noise**2 * np.eye(rows)
    columns = np.random.default_rng(1).standard_normal((3, rows)).cumsum(axis=1)
    found = replace(Whitening.of(one), noise=sensor_noise).of_columns(columns)
    assert found @ found.T == pytest.approx(columns @ np.linalg.solve(covariance, columns.T), rel=1e-4)


def test_what_is_not_known_of_the_torques_widens_the_bound():
    one = drive(MEASURED)
    told = cramer_rao(replace(one, dimensions={**one.dimensions, "torque": "commanded"}))
    assert all(half > told[name] for name, half in cramer_rao(one).items())
    slow = drive(SLOW)
    assert len(load_changes(slow)) == 3
    known = cramer_rao(replace(slow, motion=replace(slow.motion, load="none")))
    assert all(half > 0.999 * known[name] for name, half in cramer_rao(slow).items())
    assert cramer_rao(slow)["inertia_load"] > 1.05 * known["inertia_load"]

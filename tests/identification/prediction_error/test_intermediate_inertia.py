"""A joint piece on the shaft: the model against the exact simulator, and what it wins on a plant that has one."""

from __future__ import annotations

import numpy as np
import pytest
from lagged_drive import DT, PLANT, THETA

import lostmotion as lm
from lostmotion.identification.prediction_error.gain_schedule import LADDER, Box, Stage, bandwidth_for, fit
from lostmotion.identification.prediction_error.innovations import (
    NAMES,
    Bandwidth,
    Predictor,
    from_theta,
)
from lostmotion.identification.prediction_error.intermediate_inertia import JointPredictor, with_joint_piece
from lostmotion.kernels.innovations.intermediate_inertia import two_springs
from lostmotion.rig import eigenfrequencies

SHARE, COMPLIANCE = 0.08, 0.4
GAIN = Bandwidth(500.0, 25.0)


def chain(motor_friction: float = 0.0) -> lm.Drivetrain:
    """Three masses with the torsional mode of PLANT."""
    before, behind = two_springs(PLANT.inertia_motor, PLANT.inertia_load, PLANT.stiffness, SHARE, COMPLIANCE)
    rate = PLANT.damping / PLANT.stiffness
    piece = SHARE * PLANT.inertia_motor
    return lm.Drivetrain(
        (PLANT.inertia_motor - piece, piece, PLANT.inertia_load),
        (lm.Shaft(before, rate * before), lm.Shaft(behind, rate * behind, PLANT.backlash)),
        (lm.Friction(motor_friction, 0.01), lm.Friction(), lm.Friction(PLANT.coulomb, PLANT.viscous)),
        lm.Actuator(PLANT.lag),
    )


def recorded(plant: lm.Drivetrain, noise: float, seconds: float = 4.0) -> tuple[np.ndarray, np.ndarray]:
    torque = lm.signals.excitation(seconds, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    speed = lm.simulate(plant, torque_motor=torque, dt=DT)["speed_motor"]
    return torque, speed + noise * np.random.default_rng(3).standard_normal(torque.size)


@pytest.mark.parametrize("share", [0.01, 0.3])
@pytest.mark.parametrize("compliance", [0.1, 0.9])
def test_the_torsional_mode_is_that_of_the_two_masses(share: float, compliance: float):
    jm, jl, k = PLANT.inertia_motor, PLANT.inertia_load, PLANT.stiffness
    before, behind = two_springs(jm, jl, k, share, compliance)
    assert behind / before == pytest.approx(compliance / (1.0 - compliance))
    three = lm.Drivetrain(((1.0 - share) * jm, share * jm, jl), (lm.Shaft(before), lm.Shaft(behind)))
    assert eigenfrequencies(three)[1] == pytest.approx(PLANT.pole_frequency, rel=1e-9)


def test_it_predicts_what_the_simulator_does():
    """Without noise nothing is left but the sampling: gap and friction are held over a sample."""
    base = PLANT.with_parameters(coulomb_motor=0.3, viscous_motor=0.01)
    torque, speed = recorded(chain(0.3), 0.0)
    joint = JointPredictor(torque, speed, DT, False, base, 1000, share=SHARE, compliance=COMPLIANCE)
    left = np.std(joint.residual(THETA, GAIN))
    for wrong in (
        Predictor(torque, speed, DT, False, base, 1000),
        JointPredictor(torque, speed, DT, False, base, 1000, share=1.1 * SHARE, compliance=COMPLIANCE),
        JointPredictor(torque, speed, DT, False, base, 1000, share=SHARE, compliance=1.1 * COMPLIANCE),
        JointPredictor(torque, speed, DT, False, PLANT, 1000, share=SHARE, compliance=COMPLIANCE),
    ):
        assert np.std(wrong.residual(THETA, GAIN)) > 2.0 * left
    assert left < 1e-4 * np.ptp(speed)


def test_pieces_of_a_recording_are_predicted_each_by_itself():
    torque, speed = recorded(chain(), 0.02, 1.0)
    whole = JointPredictor(torque, speed, DT, True, PLANT, 100, (0, 4000, torque.size), 500, share=SHARE)
    found = whole.residual(THETA, GAIN)
    later = JointPredictor(torque[4000:], speed[4000:], DT, True, PLANT, 500, share=SHARE).residual(
        THETA, GAIN
    )
    np.testing.assert_array_equal(found[4000:], later)
    np.testing.assert_array_equal(
        whole.part(slice(4000, torque.size)).residual(THETA, GAIN)[500:], later[500:]
    )


def test_a_counted_speed_is_compared_with_the_mean_of_the_last_two():
    torque = lm.signals.excitation(2.0, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    angle = lm.simulate(chain(), torque_motor=torque, dt=DT)["angle_motor"]
    speed = np.diff(angle, prepend=angle[0]) / DT
    base = PLANT.with_parameters(viscous_motor=0.01)
    right, wrong = (
        JointPredictor(torque, speed, DT, averaged, base, 1000, share=SHARE, compliance=COMPLIANCE)
        for averaged in (True, False)
    )
    assert np.std(right.residual(THETA, GAIN)) < 0.5 * np.std(wrong.residual(THETA, GAIN))


def fitted(plant: lm.Drivetrain, noise: float = 0.02):
    torque, speed = recorded(plant, noise)
    predictor = Predictor(torque, speed, DT, False, PLANT, 1000)
    box = Box.around(THETA, DT)
    theta, free, stages = THETA, list(range(8)), []
    for rung in LADDER[:2]:
        bandwidth = bandwidth_for(PLANT, rung)
        found = fit(predictor, theta, free, box, bandwidth)
        stages.append(Stage(found, bandwidth, free, found.iterations))
        theta = found.theta
    return predictor, stages, with_joint_piece(predictor, stages, box)


def test_a_piece_is_found_and_takes_the_bias():
    _, stages, found = fitted(chain())
    assert found is not None
    joint, stage = found
    assert joint.joint_piece == pytest.approx((SHARE, COMPLIANCE), rel=0.1)
    assert stage.bandwidth == stages[-1].bandwidth

    def errors(theta: np.ndarray) -> dict[str, float]:
        values = dict(zip(NAMES, from_theta(theta, DT), strict=True))
        return {
            n: abs(values[n] / getattr(PLANT, n) - 1.0) for n in ("inertia_motor", "stiffness", "backlash")
        }

    before, after = errors(stages[-1].fit.theta), errors(stage.fit.theta)
    assert max(after.values()) < 0.004 < max(before.values())
    assert after["inertia_motor"] < 0.3 * before["inertia_motor"]


def test_two_masses_get_none():
    assert fitted(PLANT)[2] is None


def test_the_jacobian_forgives_what_the_piece_can_make_up_for():
    predictor, _, found = fitted(chain())
    joint, stage = found
    free = [0, 2, 7]
    j = joint.jacobian(stage.fit.theta, stage.bandwidth, free, stage.fit.residual)
    told, piece = joint.both_jacobians(stage.fit.theta, stage.bandwidth, free, stage.fit.residual)
    assert j.shape == told.shape == (3, len(predictor.speed)) and piece.shape == (2, len(predictor.speed))
    scale = np.linalg.norm(told, axis=1)[:, None] * np.linalg.norm(piece, axis=1)
    assert np.max(np.abs(j @ piece.T) / scale) < 1e-6
    assert np.all(np.linalg.norm(j, axis=1) < np.linalg.norm(told, axis=1))


@pytest.mark.parametrize("seed", [3, 10])
def test_on_the_rig(seed: int):
    recording, truth = lm.rig.record(seed)
    start = lm.Drivetrain.two_mass(**{n: truth.parameters[n] * 1.3 for n in NAMES})
    found = lm.identify(recording, start=start)
    assert found.prediction.joint_piece is not None
    for name, most in (
        ("inertia_motor", 0.015),
        ("inertia_load", 0.005),
        ("stiffness", 0.02),
        ("backlash", 0.01),
    ):
        assert found.values[name] == pytest.approx(truth.parameters[name], rel=most), name

"""What modes beyond the model add to the shaft torque's standard deviation: one rule for filters and fixed gains."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.compare.cases import CASES
from lostmotion.compare.experiment import experiment as rig_case
from lostmotion.errors import InvalidInput
from lostmotion.observers import (
    extended_kalman,
    interacting_models,
    kalman,
    moving_horizon,
    standard_deviations,
    unscented_kalman,
)
from lostmotion.observers.filters.tuning import EIGENMODE_MEMORY, EIGENMODE_SHARE
from lostmotion.signals import excitation
from lostmotion.simulation import simulate

FILTERS = (extended_kalman, unscented_kalman, interacting_models, moving_horizon)
DT = 1e-4
#: Standard deviation of one sample of the motor speed, rad/s; unknown torque of both inertias, Nm·√s.
SENSOR, TORQUE = 0.03, 0.02
UNKNOWN = {"motor": TORQUE, "load": TORQUE}


@pytest.fixture(scope="module", params=["nominal", "sticking"])
def work(request):
    """Hard reversals, and a load that rests half of the time: the shaft torque is ten times smaller then."""
    return rig_case(next(case for case in CASES if case.name == request.param), 6, 1.5)


def observed(make, plant, given, counted=True, **options):
    """Estimates and deviations; Observer 1's by ``standard_deviations``."""
    if make is not kalman:
        result = make(plant, dt=DT, speed_from_counts=counted, **options).run(given)
        return result, result
    law = kalman(plant, dt=DT, speed_from_counts=counted)
    told = standard_deviations(
        law, given,
        process_covariance={
            "speed_motor": (TORQUE / plant.inertia_motor) ** 2, "speed_load": (TORQUE / plant.inertia_load) ** 2
        },
        measurement_covariance={"speed_motor": SENSOR**2 * DT}, **options,
    )  # fmt: skip
    return law.run(given), told


def judged(estimate, told, truth, rows):
    """Share of the errors within two deviations, deviation over error."""
    error = (estimate["torque_shaft_estimated"] - truth)[rows]
    deviation = told["torque_shaft_deviation"][rows]
    # In the gap of the model the torque is zero up to rounding.
    within = np.mean(np.abs(error) <= 2.0 * deviation + 1e-9)
    return within, np.sqrt(np.mean(deviation**2) / np.mean(error**2))


@pytest.mark.parametrize("make", [*FILTERS, kalman])
def test_on_the_rig_the_errors_are_within_their_deviations(make, work):
    given = work.recording.only("torque_motor", "speed_motor")
    within, ratio = judged(*observed(make, work.drivetrain, given), work.truth["torque_shaft"], work.judged)
    assert 0.9 < within < 0.99
    assert 0.75 < ratio < 2.2
    without, _ = judged(
        *observed(make, work.drivetrain, given, eigenmode_share=0.0), work.truth["torque_shaft"], work.judged
    )
    assert without < 0.6


@pytest.mark.parametrize("make", [*FILTERS, kalman])
def test_without_a_share_they_are_right_on_their_own_model(make):
    rng = np.random.default_rng(7)
    torque = excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    white = TORQUE / np.sqrt(DT) * rng.normal(size=(2, torque.size))
    true = simulate(PAPER, dt=DT, torque_motor=torque + white[0], torque_load=white[1])
    speed = true["speed_motor"] + SENSOR * rng.normal(size=torque.size)
    told = {"sensor_noise": {"speed_motor": SENSOR}, "process_torque": UNKNOWN} if make is not kalman else {}
    given = {"torque_motor": torque, "speed_motor": speed}
    result = observed(make, PAPER, given, counted=False, eigenmode_share=0.0, **told)
    within, ratio = judged(*result, true["torque_shaft"], slice(3000, None))
    assert within > 0.93
    assert 0.85 < ratio < 1.4


@pytest.mark.parametrize("make", [*FILTERS, kalman])
def test_it_is_a_share_of_the_torques_own_running_deviation_and_changes_nothing_else(make, work):
    given = work.recording.only("torque_motor", "speed_motor").window(0.0, 0.3)
    (estimate, told), (same, without) = (
        observed(make, work.drivetrain, given, eigenmode_share=share) for share in (0.2, 0.0)
    )
    for first, second in ((estimate, same), (told, without)):
        for name in set(first) - {"torque_shaft_deviation"}:
            np.testing.assert_array_equal(first[name], second[name], err_msg=name)
    rate = 1.0 - np.exp(-DT / EIGENMODE_MEMORY)
    mean = variance = 0.0
    expected = []
    for torque in estimate["torque_shaft_estimated"]:
        variance += rate * ((torque - mean) ** 2 - variance)
        mean += rate * (torque - mean)
        expected.append(0.2**2 * variance)
    expected = np.sqrt(without["torque_shaft_deviation"] ** 2 + expected)
    np.testing.assert_allclose(told["torque_shaft_deviation"], expected, rtol=1e-9)


def test_a_steady_torque_makes_no_mode_swing():
    """10 Nm held against a load that rests."""
    plant = PAPER.with_parameters(coulomb=20.0)
    given = {"torque_motor": np.full(5000, 10.0), "speed_motor": np.zeros(5000)}
    usual, without = (
        observed(kalman, plant, given, eigenmode_share=share) for share in (EIGENMODE_SHARE, 0.0)
    )
    assert usual[0]["torque_shaft_estimated"][-1] == pytest.approx(10.0, abs=0.5)
    added = usual[1]["torque_shaft_deviation"] ** 2 - without[1]["torque_shaft_deviation"] ** 2
    assert added.max() > 0.1
    assert added[-1] < 1e-4


@pytest.mark.parametrize("make", [extended_kalman, unscented_kalman, interacting_models])
def test_a_lost_estimate_forgets_what_the_torque_did(make):
    torque, speed = 20.0 * np.sin(200.0 * np.arange(300) * DT), np.zeros(300)
    usual, without = (make(PAPER, dt=DT, eigenmode_share=share) for share in (EIGENMODE_SHARE, 0.0))
    state = usual.init()
    for inputs in zip(torque, speed, strict=True):
        state, _, _ = usual.step(state, inputs)
    at = usual.outputs.index("torque_shaft_deviation")
    _, swinging, _ = usual.step(state, [0.0, 0.0])
    _, alone, _ = without.step(state, [0.0, 0.0])
    assert swinging[at] ** 2 - alone[at] ** 2 > 0.1
    state = np.array(state)
    state[0] = 1e9  # a twist beyond every drivetrain's
    _, again, _ = usual.step(state, [0.0, 0.0])
    _, alone, _ = without.step(state, [0.0, 0.0])
    assert again[at] == pytest.approx(alone[at], rel=1e-12)


def test_a_share_below_zero_is_refused():
    with pytest.raises(InvalidInput, match="zero or more"):
        extended_kalman(PAPER, dt=DT, eigenmode_share=-0.1)
    with pytest.raises(InvalidInput, match="zero or more"):
        observed(
            kalman, PAPER, {"torque_motor": np.zeros(3), "speed_motor": np.zeros(3)}, eigenmode_share=-0.1
        )

"""Standard deviations of the fixed gains: as large as the errors are, growing in the gap and without a sensor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are
from table_i import PAPER

from lostmotion.errors import InvalidInput
from lostmotion.observers import disturbance_observer, h_infinity, kalman, shaft_torque, standard_deviations
from lostmotion.observers.fixed_gain.kalman import covariances_of
from lostmotion.observers.fixed_gain.sampled_model import sampled_model
from lostmotion.signals import excitation
from lostmotion.simulation import simulate

PLANT = PAPER.with_parameters(coulomb=0.0)
DT = 1e-4
#: Standard deviation of one sample: unknown torques on motor and load (Nm), motor speed (rad/s).
MOTOR, LOAD, SENSOR = 2.0, 6.0, 0.05
#: The same as densities of a continuous process.
PROCESS = {
    "twist": 0.0,
    "speed_motor": (MOTOR / PLANT.inertia_motor) ** 2 * DT,
    "speed_load": (LOAD / PLANT.inertia_load) ** 2 * DT,
}
MEASUREMENT = {"speed_motor": SENSOR**2 * DT}


@pytest.fixture(scope="module")
def noisy():
    """4 s under torques that no observer is told: the true signals, and what it gets."""
    torque = excitation(4.0, DT, seed=4, inertia=0.1292, coulomb=0.0, viscous=0.0175)
    n, rng = torque.size, np.random.default_rng(5)
    true = simulate(
        PLANT, dt=DT, torque_motor=torque + MOTOR * rng.normal(size=n), torque_load=LOAD * rng.normal(size=n)
    )
    speed = true["speed_motor"] + SENSOR * rng.normal(size=n)
    return true, {"torque_motor": torque, "speed_motor": speed}


def observer():
    return kalman(PLANT, dt=DT, process_covariance=PROCESS, measurement_covariance=MEASUREMENT)


def found(given, law=None, **options):
    return standard_deviations(
        law or observer(),
        given,
        process_covariance=PROCESS,
        measurement_covariance=MEASUREMENT,
        **options,
    )


def test_deviations_are_as_large_as_the_errors(noisy):
    true, given = noisy
    estimate, told = observer().run(given), found(given)
    for signal in ("speed_load", "speed_motor", "twist"):
        error = estimate[f"{signal}_estimated"] - true[signal]
        normalised = error[5000:] / told[f"{signal}_deviation"][5000:]
        assert 0.85 < np.sqrt(np.mean(normalised**2)) < 1.2, signal
        assert 0.9 < np.mean(np.abs(normalised) < 2.0) < 0.98, signal


def test_same_seed_same_bytes(noisy):
    _, given = noisy
    short = {name: values[:500] for name, values in given.items()}
    first, second, other = (found(short, seed=seed)["twist_deviation"] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, second)
    assert np.any(first != other)


def test_deviation_of_the_load_grows_in_the_gap(noisy):
    _, given = noisy
    told = found(given)["speed_load_deviation"]
    open_ = observer().run(given)["torque_shaft_estimated"] == 0.0
    edges = np.flatnonzero(np.diff(np.concatenate([[0], open_, [0]]).astype(int))).reshape(-1, 2)
    gaps = edges[edges[:, 1] - edges[:, 0] > 40]  # of more than 4 ms
    assert len(gaps) > 80
    growth = told[gaps[:, 1] - 1] / told[gaps[:, 0]]
    assert np.median(growth) > 1.1


def test_deviations_grow_while_the_sensor_fails_and_come_back(noisy):
    _, given = noisy
    speed = given["speed_motor"].copy()
    speed[20_000:20_200] = np.nan
    broken = {**given, "speed_motor": speed}
    assert np.all(observer().run(broken)["input_fault"][20_000:20_200] == 1.0)
    told, usual = found(broken)["speed_motor_deviation"], found(given)["speed_motor_deviation"]
    assert told[20_199] > 3.0 * usual[20_199]
    assert told[20_700] == pytest.approx(usual[20_700], rel=0.1)


def test_in_contact_they_settle_where_the_riccati_equation_says():
    plant = PLANT.with_parameters(backlash=0.0)
    law = kalman(plant, dt=DT, process_covariance=PROCESS, measurement_covariance=MEASUREMENT)
    given = {"torque_motor": np.zeros(100), "speed_motor": np.zeros(100)}
    told = found(given, law, samples=2000)["speed_load_deviation"]
    design = sampled_model(plant, ("speed_motor",), DT)
    q, r = covariances_of(design, PROCESS, MEASUREMENT)
    p = solve_discrete_are(design.step(design.model.A).T, design.c.T, design.noise(design.model.A, q), r / DT)
    np.testing.assert_allclose(told, np.sqrt(p[2, 2]), rtol=0.1)  # 2000 samples of the error


@pytest.mark.parametrize(
    "law",
    [
        kalman(PLANT.with_parameters(coulomb=2.0), dt=DT, load_torque=True, contact_scheduling=True),
        kalman(PLANT, dt=DT, measured=("torque_shaft", "speed_motor"), speed_from_counts=True),
        h_infinity(PLANT, dt=DT),
        disturbance_observer(PLANT, dt=DT),
        shaft_torque(PLANT.stiffness, dt=DT),
    ],
    ids=["scheduled", "both sensors", "H∞", "momentum", "shaft torque"],
)
def test_every_fixed_gain_has_them(law):
    rng = np.random.default_rng(1)
    told = standard_deviations(
        law,
        {name: rng.normal(size=500) for name in law.inputs},
        process_covariance=dict.fromkeys(law.states, 1.0),
        measurement_covariance={name: 1e-6 for name in law.inputs if name != "torque_motor"},
    )
    assert set(told) == {name.replace("_estimated", "_deviation") for name in law.outputs}
    for name in told:
        assert np.all(np.isfinite(told[name])), name
        assert np.any(told[name] > 0.0), name


def test_misuse_says_what_to_do():
    given = {"torque_motor": np.zeros(10), "speed_motor": np.zeros(10)}
    right = {"process_covariance": PROCESS, "measurement_covariance": MEASUREMENT}
    for wrong, message in (
        ({"process_covariance": {"speed": 1.0}}, "names out of"),
        ({"measurement_covariance": {"torque_motor": 1.0}}, "names out of"),
        ({"measurement_covariance": {"speed_motor": -1.0}}, "zero or positive"),
        ({"samples": 1}, "at least 2"),
    ):
        with pytest.raises(InvalidInput, match=message):
            standard_deviations(observer(), given, **{**right, **wrong})
    without = replace(observer(), A=np.eye(len(observer().states)) * 1.01)
    with pytest.raises(InvalidInput, match="unit circle"):
        standard_deviations(without, given, **right)


def test_a_missing_motor_torque_counts_as_known(noisy):
    linear = PLANT.with_parameters(backlash=0.0)
    law = kalman(linear, dt=DT, process_covariance=PROCESS, measurement_covariance=MEASUREMENT)
    given = {name: values[:500] for name, values in noisy[1].items()}
    gone = {**given, "torque_motor": np.where(np.arange(500) < 300, given["torque_motor"], np.nan)}
    # Without modes: theirs follow the estimated torque, which the missing samples do change.
    options = {"process_covariance": PROCESS, "measurement_covariance": MEASUREMENT, "eigenmode_share": 0.0}
    told, wanted = (standard_deviations(law, data, **options) for data in (gone, given))
    for name in told:
        np.testing.assert_array_equal(told[name], wanted[name])

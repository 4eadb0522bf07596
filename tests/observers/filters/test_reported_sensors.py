"""What filters make of their sensors: two that know of the modes on the shaft, and coarser ones than they were told."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.compare import CASES
from lostmotion.compare.experiment import Experiment, experiment
from lostmotion.errors import InvalidInput
from lostmotion.observers import extended_kalman, interacting_models, moving_horizon, unscented_kalman
from lostmotion.recording import Recording
from lostmotion.signals import excitation
from lostmotion.simulation import Sensor, measure, simulate

FILTERS = (extended_kalman, unscented_kalman, interacting_models)
BOTH = ("torque_shaft", "speed_motor")


def made(case: str, seed: int, duration: float) -> Experiment:
    return experiment(next(c for c in CASES if c.name == case), seed, duration)


def run(make, data: Experiment, **options) -> Recording:
    observer = make(data.drivetrain, dt=data.sensing.dt, speed_from_counts=True, **options)
    return observer.run(data.recording.only(*observer.inputs))


def error(found: Recording, data: Experiment, signal: str) -> float:
    """RMSE in % of range."""
    true = data.truth[signal][data.judged]
    wrong = found[f"{signal}_estimated"][data.judged] - true
    return float(100.0 * (wrong**2).mean() ** 0.5 / (true.max() - true.min()))


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("make", [*FILTERS, moving_horizon])
def test_a_torque_sensor_does_no_harm(make, seed):
    """The rig's 750 Hz mode is 2 Nm on the shaft, seven times the sensor's noise."""
    data = made("nominal", seed, 1.2)
    noise = {"speed_motor": data.sensing.speed_noise, "torque_shaft": data.sensing.torque_noise}
    alone = run(make, data, sensor_noise={"speed_motor": noise["speed_motor"]})
    both = run(make, data, sensor_noise=noise, measured=BOTH)
    for signal in ("speed_load", "torque_shaft"):
        assert error(both, data, signal) < 1.05 * error(alone, data, signal), signal
    assert both["input_fault"].mean() < 0.005


@pytest.mark.parametrize("bits", [14, 12, 10])
@pytest.mark.parametrize("make", FILTERS)
def test_a_coarser_encoder_than_told_shows_itself(make, bits):
    """With 12 bit a count is 15 rad/s at 0.1 ms, where the default tells 0.025 rad/s."""
    data = made(f"encoder {bits} bit", 1, 1.2)
    found = run(make, data)
    told = run(make, data, sensor_noise={"speed_motor": data.sensing.speed_noise})
    assert error(found, data, "speed_load") < 1.3 * error(told, data, "speed_load")
    assert found["input_fault"].mean() < 0.01


@pytest.mark.parametrize("resolution", [0.0, 0.2])
@pytest.mark.parametrize("make", [*FILTERS, moving_horizon])
def test_a_torque_that_is_exactly_zero_in_the_gap_is_no_frozen_one(make, resolution):
    """A sensor without noise, or with coarse steps, repeats its zero while the twist moves: 5 % when it was refused."""
    work = excitation(1.5, 1e-4, seed=22, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    exact = simulate(PAPER, dt=1e-4, torque_motor=work)
    sensors = {
        "torque_shaft": Sensor("torque_shaft", resolution=resolution),
        "speed_motor": Sensor("speed_motor"),
    }
    shown = {"torque_motor": work, **measure(sensors, exact.signals, 1e-4, 1)}
    found = make(PAPER, dt=1e-4, measured=BOTH).run(shown)
    wrong = found["speed_load_estimated"] - exact["speed_load"]
    assert (wrong**2).mean() ** 0.5 < 1e-3 * np.ptp(exact["speed_load"])
    assert found["input_fault"].mean() < 0.005


def test_the_order_of_the_sensors_does_not_matter_much():
    data = made("nominal", 1, 1.2)
    first, second = (run(extended_kalman, data, measured=order) for order in (BOTH, BOTH[::-1]))
    assert error(first, data, "speed_load") == pytest.approx(error(second, data, "speed_load"), rel=0.1)


@pytest.mark.parametrize("make", FILTERS)
def test_misuse_says_what_to_do(make):
    plant = made("nominal", 1, 1.0).drivetrain
    for wrong, message in (
        ({"dt": float("nan")}, "dt: got nan"),
        ({"dt": float("inf")}, "dt: got inf"),
        ({"dt": 1e-4, "sensor_noise": 0.03}, "a mapping"),
        ({"dt": 1e-4, "sensor_noise": {"torque_shaft": 0.3}}, "Measure them"),
        ({"dt": 1e-4, "drift": {"backlsh": 0.3}}, "names out of"),
    ):
        with pytest.raises(InvalidInput, match=message):
            make(plant, **wrong)

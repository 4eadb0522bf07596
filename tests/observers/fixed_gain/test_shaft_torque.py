"""Load speed from motor speed and shaft torque: on a simulated shaft, and on the measured thruster rig."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.observers import shaft_torque

SHAFT = lm.Drivetrain.two_mass(
    inertia_motor=0.01, inertia_load=0.02, stiffness=110.0, coulomb=0.3, viscous=0.01
)
DT = 1e-3


def band(values, dt, low=5.0, high=60.0):
    """The part between low and high (Hz)."""
    spectrum, frequency = np.fft.rfft(values - np.mean(values)), np.fft.rfftfreq(values.size, dt)
    return np.fft.irfft(np.where((frequency < low) | (frequency > high), 0.0, spectrum), values.size)


def error_ratio(estimate, recording):
    """RMSE of an estimate of the load speed over that of the motor speed taken for it, 5 to 60 Hz, ends left out."""
    load, motor, found = (
        band(v, recording.dt)[500:-500] for v in (recording["speed_load"], recording["speed_motor"], estimate)
    )
    return float(np.sqrt(np.mean((found - load) ** 2) / np.mean((motor - load) ** 2)))


@pytest.fixture(scope="module")
def recording():
    torque = 3.0 + lm.signals.noise(1.0, 60.0, 1.0, 6.0, DT, seed=1)
    fine = lm.simulate(SHAFT, dt=1e-4, torque_motor=np.repeat(torque, 10))
    late = np.interp(fine.time - 4e-4, fine.time, fine["torque_shaft"])
    signals = {n: fine[n][::10] for n in ("speed_motor", "speed_load")}
    return lm.Recording(time=fine.time[::10], signals={**signals, "torque_shaft": late[::10]})


def test_the_load_is_followed_and_the_delay_made_good(recording):
    given = recording.only("speed_motor", "torque_shaft")
    ratios = [
        error_ratio(shaft_torque(110.0, dt=DT, torque_delay=d).run(given)["speed_load_estimated"], recording)
        for d in (4e-4, 0.0)
    ]
    assert ratios[0] < 0.04
    assert ratios[1] > 2.0 * ratios[0]


def test_mean_speed_and_twist_are_exact_at_rest_of_the_twist():
    steady = {"speed_motor": np.full(3000, 20.0), "torque_shaft": np.full(3000, 5.5)}
    found = shaft_torque(110.0, dt=DT, torque_delay=4e-4).run(steady)
    assert found["speed_load_estimated"][-1] == pytest.approx(20.0, abs=1e-6)
    assert found["twist_elastic_estimated"][-1] == pytest.approx(0.05, abs=1e-9)


def test_covariance_of_the_jerk_is_the_integral():
    from lostmotion.observers.fixed_gain.shaft_torque import _jerk_covariance

    s = np.linspace(0.0, 0.1, 20_001)
    v = np.stack([-(s**2) / 2.0, s, np.ones_like(s)])
    wanted = np.trapezoid(v[:, None] * v[None], s, axis=2)
    np.testing.assert_allclose(_jerk_covariance(2.0, 0.1), 4.0 * wanted, rtol=1e-6)


@pytest.mark.parametrize("known, tried, limit", [("step", "sin", 0.03), ("sin", "step", 0.1)])
def test_on_the_thruster_rig_with_the_load_withheld(measured_data, known, tried, limit):
    """Stiffness and delay from one recording, the load speed of the other."""
    channels = {"speed_motor": 1, "speed_load": 2, "torque_shaft": 3}
    first, second = (
        lm.read_recording(measured_data / "aalto" / f"{name}_sensor.csv", channels=channels, time=0)
        for name in (known, tried)
    )
    shaft = lm.shaft_stiffness(first)
    given = second.only("speed_motor", "torque_shaft")
    ratios = [
        error_ratio(
            shaft_torque(shaft.values["stiffness"], dt=second.dt, torque_delay=delay).run(given)[
                "speed_load_estimated"
            ],
            second,
        )
        for delay in (shaft.values["torque_delay"], 0.0)
    ]
    assert ratios[0] < limit
    assert ratios[1] > 1.2 * ratios[0]


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"stiffness": 0.0}, "stiffness"),
        ({"torque_noise": -1.0}, "torque_noise"),
        ({"jerk": float("nan")}, "jerk"),
        ({"torque_delay": 0.1}, "Shift the torque"),
        ({"torque_delay": float("nan")}, "Shift the torque"),
        ({"dt": 0.0}, "dt"),
    ],
)
def test_misuse(arguments, complaint):
    given = {"stiffness": 110.0, "dt": DT, **arguments}
    with pytest.raises(InvalidInput, match=complaint):
        shaft_torque(given.pop("stiffness"), **given)

"""Covariances from a recording: found where they are known, better than the guess, misuse."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.errors import InvalidInput
from lostmotion.observers import covariances, kalman
from lostmotion.simulation import simulate

DT = 5e-4
#: Torque (Nm) that nobody knows of, held over each sample, and sensor noise (rad/s).
MOTOR, LOAD, SENSOR = 1.0, 6.0, 0.05


@pytest.fixture(scope="module")
def recording():
    rng = np.random.default_rng(1)
    n = 12_000
    known = 8.0 + 4.0 * np.sign(np.sin(2.0 * np.pi * 3.0 * DT * np.arange(n)))
    true = simulate(
        PAPER, dt=DT, torque_motor=known + MOTOR * rng.normal(size=n), torque_load=LOAD * rng.normal(size=n)
    )
    noisy = true["speed_motor"] + SENSOR * rng.normal(size=n)
    return true.with_signals("measured", torque_motor=known, speed_motor=noisy)


@pytest.fixture(scope="module")
def found(recording):
    return covariances(recording, PAPER)


def test_what_was_put_in_is_found(found):
    # A torque σ held over each sample is a density of (σ/J)²·dt, a sensor's σ one of σ²·dt.
    assert found.converged
    assert found.process["speed_motor"] == pytest.approx((MOTOR / PAPER.inertia_motor) ** 2 * DT, rel=0.3)
    assert found.process["speed_load"] == pytest.approx((LOAD / PAPER.inertia_load) ** 2 * DT, rel=0.5)
    assert found.measurement["speed_motor"] == pytest.approx(SENSOR**2 * DT, rel=0.2)
    assert found.process["twist"] == 0.0


def test_its_observer_is_better_than_the_guess(recording, found):
    assert found.innovation_rms["speed_motor"] < 0.98 * found.start_rms["speed_motor"]
    tuned = found.observer(PAPER, dt=DT)
    np.testing.assert_allclose(tuned.B[:3, 1:], found.gain, rtol=1e-12)

    def error(law):
        run = law.run(recording.only("torque_motor", "speed_motor"))
        return float(np.std((run["speed_load_estimated"] - recording["speed_load"])[1000:]))

    assert error(tuned) < 0.9 * error(kalman(PAPER, dt=DT))


def test_sensitivity_is_the_curvature_of_the_cost(recording, found):
    assert all(value > 0.01 for value in found.sensitivity.values())
    alone = covariances(recording, PAPER, searched=("speed_motor",))
    assert set(alone.sensitivity) == {"speed_motor"}
    assert alone.process["speed_load"] == 0.0


def test_the_ratio_of_two_sensors(recording):
    rng = np.random.default_rng(2)
    both = recording.with_signals(
        "measured", torque_shaft=recording["torque_shaft"] + 2.0 * rng.normal(size=len(recording))
    )
    two = covariances(both, PAPER, measured=("speed_motor", "torque_shaft"))
    assert two.measurement["torque_shaft"] == pytest.approx(4.0 * DT, rel=0.3)
    assert two.measurement["speed_motor"] == pytest.approx(SENSOR**2 * DT, rel=0.5)


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"searched": ()}, "searched"),
        ({"searched": ("speed",)}, "searched"),
        ({"searched": ("speed_load", "speed_load")}, "searched"),
        ({"measured": ("angle_motor",)}, "other"),
    ],
)
def test_misuse(recording, arguments, complaint):
    short = recording.only("torque_motor", "speed_motor")
    with pytest.raises(InvalidInput, match=complaint if complaint != "other" else "angle_motor"):
        covariances(short, PAPER, **arguments)


def test_a_short_recording(recording):
    with pytest.raises(InvalidInput, match="Record longer"):
        covariances(recording.window(0.0, 1.0), PAPER)

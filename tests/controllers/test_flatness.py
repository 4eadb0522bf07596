"""The course keeps its limits and does not overshoot; along it the torque is fed forward."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import flatness, lqi, speed_course
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.simulation import Sensor, simulate
from lostmotion.systems import connect

DT = 1e-4
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, lag=3e-4
)
LIMITS = {"largest_acceleration": 300.0, "largest_jerk": 1e5}


@pytest.mark.parametrize("size", [0.01, 4.0, 100.0])
def test_a_course_keeps_its_limits_and_does_not_overshoot(size):
    law = speed_course(**LIMITS, dt=DT)
    found = law.run({"speed_reference": np.full(20000, size)})
    speed, acceleration = found["speed_course"], found["acceleration_course"]
    assert np.max(np.abs(found["jerk_course"])) <= 1e5 and np.max(acceleration) <= 300.0
    assert np.max(speed) <= size * (1.0 + 1e-6) and speed[-1] == pytest.approx(size, rel=1e-3)
    # The three belong together: integrals of each other.
    np.testing.assert_allclose(np.diff(acceleration), DT * found["jerk_course"][:-1], atol=1e-9)
    step = DT * acceleration[:-1] + 0.5 * DT**2 * found["jerk_course"][:-1]
    np.testing.assert_allclose(np.diff(speed), step, atol=1e-9)


def follow(plant, law):
    observer = kalman(plant, dt=DT, load_torque=True).renamed({"torque_motor": "torque_motor_acting"})
    joined = connect(
        [observer, law],
        inputs=("speed_reference", "speed_motor", "torque_motor_acting"),
        outputs=("torque_motor",),
    )
    reference = np.where(np.arange(3000) < 100, 0.0, 4.0)
    return simulate(
        plant, dt=DT, law=joined, delay=1, speed_reference=reference,
        sensors={"torque_motor_acting": Sensor("torque_motor")},
    )  # fmt: skip


def test_with_the_feedforward_the_load_stays_on_its_course():
    wishes = {"dt": DT, "largest_error": 2.0, "largest_torque": 73.5}
    run = follow(PLANT, flatness(PLANT, **LIMITS, **wishes))
    course = speed_course(**LIMITS, dt=DT)
    wanted = course.run({"speed_reference": run["speed_reference"]})["speed_course"]
    with_it = np.max(np.abs(run["speed_load"] - wanted))
    # The same feedback without the feedforward.
    slow = connect(
        [course, lqi(PLANT, **wishes).renamed({"speed_reference": "speed_course"})],
        inputs=tuple(n for n in lqi(PLANT, **wishes).inputs), outputs=("torque_motor",),
    )  # fmt: skip
    without = np.max(np.abs(follow(PLANT, slow)["speed_load"] - wanted))
    # What is left is the shaft, which no torque twists as fast as the jerk turns.
    assert with_it < 0.12 and with_it < 0.2 * without


@pytest.mark.parametrize(
    "changes", [{"largest_jerk": 1e9}, {"largest_jerk": -1.0}, {"largest_acceleration": np.nan}]
)
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"speed_course.{next(iter(changes))}"):
        speed_course(**{**LIMITS, **changes}, dt=DT)

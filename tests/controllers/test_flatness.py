"""The course keeps its limits and does not overshoot; along it the torque is fed forward."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import flatness, lqi, speed_course
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.simulation import Sensor, simulate
from lostmotion.systems import DiscreteSystem, connect

DT = 1e-4
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, lag=3e-4
)
LIMITS = {"largest_acceleration": 300.0, "largest_jerk": 1e5}
WISHES = {"dt": DT, "largest_error": 2.0, "largest_torque": 73.5}
STEP = np.where(np.arange(3000) < 100, 0.0, 4.0)


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


def follow(plant, law, reference=STEP, **load):
    observer = kalman(plant, dt=DT, load_torque=True).renamed({"torque_motor": "torque_motor_acting"})
    return simulate(
        plant, dt=DT, law=[observer, law], delay=1, speed_reference=reference,
        sensors={"torque_motor_acting": Sensor("torque_motor")}, **load,
    )  # fmt: skip


def test_with_the_feedforward_the_load_stays_on_its_course():
    run = follow(PLANT, flatness(PLANT, **LIMITS, **WISHES))
    course = speed_course(**LIMITS, dt=DT)
    wanted = course.run({"speed_reference": run["speed_reference"]})["speed_course"]
    with_it = np.max(np.abs(run["speed_load"] - wanted))
    # The same feedback without the feedforward.
    slow = connect(
        [course, lqi(PLANT, **WISHES).renamed({"speed_reference": "speed_course"})],
        inputs=tuple(n for n in lqi(PLANT, **WISHES).inputs), outputs=("torque_motor",),
    )  # fmt: skip
    without = np.max(np.abs(follow(PLANT, slow)["speed_load"] - wanted))
    # What is left is the shaft, which no torque twists as fast as the jerk turns.
    assert with_it < 0.12 and with_it < 0.2 * without


def test_friction_and_load_torque_are_part_of_the_feedforward():
    """A drive with both stays on its course as one without does; one that is told of neither does not."""
    rubbing = PLANT.with_parameters(coulomb=2.0, viscous=0.05, coulomb_motor=0.5, viscous_motor=0.01)
    reference = np.where(np.arange(5000) < 3000, 2.0, 6.0)
    pulled = np.full(5000, -10.0)
    course = speed_course(**LIMITS, dt=DT).run({"speed_reference": reference})["speed_course"]

    def deviation(law):
        run = follow(rubbing, law, reference, torque_load=pulled)
        return np.max(np.abs(run["speed_load"] - course)[2900:]), abs(run["speed_load"][-1] - 6.0)

    along, left = deviation(flatness(rubbing, **LIMITS, **WISHES))
    assert along < 0.12 and left < 1e-3
    law = flatness(rubbing, **LIMITS, **WISHES)
    untold = {name: f"no_{name}" for name in ("friction_load_estimated", "torque_load_estimated")}
    nothing = DiscreteSystem(inputs=(), outputs=tuple(untold.values()), dt=DT)
    along, left = deviation(
        connect(
            [nothing, law.renamed(untold)],
            inputs=tuple(n for n in law.inputs if n not in untold),
            outputs=("torque_motor",),
        )
    )
    assert along > 0.5 and left > 0.5


@pytest.mark.parametrize(
    "changes", [{"largest_jerk": 1e9}, {"largest_jerk": -1.0}, {"largest_acceleration": np.nan}]
)
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"speed_course.{next(iter(changes))}"):
        speed_course(**{**LIMITS, **changes}, dt=DT)

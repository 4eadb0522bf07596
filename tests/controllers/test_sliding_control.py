"""Sliding mode and super-twisting: the poles of the surface, the bound of what is unknown, no chattering."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import sliding_mode, super_twisting
from lostmotion.curves import dead_zone
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.simulation import simulate
from lostmotion.systems import DiscreteSystem

DT, LIMIT = 1e-4, 73.5
PLANT = Drivetrain.two_mass(inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.0)
LAWS = {
    "sliding mode": lambda **o: sliding_mode(PLANT, **{**SIZES, **o}),
    "super-twisting": lambda **o: super_twisting(PLANT, **{**SIZES, "integral_rate": 300.0, **o}),
}
SIZES = {"dt": DT, "switching_torque": 25.0, "torque_limit": LIMIT}


def known(half=0.0):
    """What an observer would tell, without friction and load torque."""
    sources = ("twist", "speed_motor", "speed_load")
    return DiscreteSystem(
        inputs=sources, dt=DT, curves=(dead_zone(half),),
        outputs=("twist_elastic_estimated", "speed_motor_estimated", "speed_load_estimated",
                 "friction_load_estimated", "torque_load_estimated"),
        G=[[1.0, 0.0, 0.0]], D=[[0.0] * 3, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0] * 3, [0.0] * 3],
        J=[[1.0], [0.0], [0.0], [0.0], [0.0]],
    )  # fmt: skip


def step(law, size=1.0, unknown=0.0, plant=PLANT):
    n = 4000
    given = {"speed_reference": np.full(n, size), "torque_1": np.full(n, unknown)} if unknown else {
        "speed_reference": np.full(n, size)
    }  # fmt: skip
    return simulate(plant, dt=DT, law=[known(0.5 * plant.backlash), law], delay=0, **given)


@pytest.mark.parametrize("name", LAWS)
def test_on_the_surface_the_load_moves_with_the_poles(name):
    run = step(LAWS[name]())
    # Two poles at −150 1/s after s has gone to zero with its own rate: 90 % within 4/150 s and a few lags.
    t90 = run.time[np.argmax(run["speed_load"] >= 0.9)]
    assert 3.0 / 150.0 < t90 < 5.0 / 150.0
    assert np.max(run["speed_load"]) < 1.001 and run["speed_load"][-1] == pytest.approx(1.0, abs=1e-4)


def test_an_unknown_torque_at_the_motor_leaves_an_error_only_without_the_integral():
    errors = {name: 1.0 - step(make(), unknown=-5.0)["speed_load"][-1] for name, make in LAWS.items()}
    assert abs(errors["super-twisting"]) < 1e-3 < abs(errors["sliding mode"])


@pytest.mark.parametrize("name", LAWS)
def test_it_does_not_chatter(name):
    torque = step(LAWS[name](), size=0.0, unknown=-3.0)["torque_motor"][-500:]
    assert np.ptp(torque) < 0.01


@pytest.mark.parametrize("name", LAWS)
def test_misuse(name):
    for changes in ({"poles": (1.0, -2.0)}, {"poles": (-1.0,)}, {"switching_torque": 0.0}, {"rate": -1.0}):
        with pytest.raises(InvalidInput, match=next(iter(changes))):
            LAWS[name](**changes)

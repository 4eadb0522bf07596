"""PI gains by optimisation: against the formula, on a drive of another size, and with a finer plant."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from lostmotion import rig
from lostmotion.controllers import OptimisedPi, optimised_pi, pi, symmetrical_optimum
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.metrics import recovery, step_metrics
from lostmotion.simulation import simulate

DT = 1e-4
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip
ASKED = {"dt": DT, "torque_limit": 73.5, "speed": 2.0, "torque_load": 10.0}


@functools.cache
def tuned_on_the_model() -> OptimisedPi:
    return optimised_pi(PLANT, **ASKED)


def test_it_settles_sooner_and_rejects_a_load_sooner_than_the_formula() -> None:
    """On the virtual rig, which is finer than the model that it was tuned on."""
    tuned, formula = tuned_on_the_model(), symmetrical_optimum(PLANT, dt=DT, spread=None)
    assert tuned.sensitivity < 2.1
    reference = np.where(np.arange(9000) < 3000, -2.0, 2.0)
    load = np.where(np.arange(9000) < 6000, 0.0, -10.0)
    settled, overshoot, back = [], [], []
    for gains in (tuned.gains(), formula.gains()):
        law = pi(dt=DT, torque_limit=73.5, friction_of=PLANT, **gains)
        _, truth = rig.record(
            rig.nominal_rig(), law=law, dt=DT, speed_reference=reference, torque_load=load, channels=()
        )
        run = truth.signals
        step = step_metrics(run.time, run["speed_load"], 0.3, -2.0, 2.0, stop_time=0.6)
        settled.append(step.settling_time)
        overshoot.append(step.overshoot)
        back.append(recovery(run.time, reference - run["speed_load"], 0.6, 0.08).time)
    assert settled[0] < 0.6 * settled[1] and back[0] < 0.6 * back[1] and overshoot[0] < 6.0


def test_friction_in_the_cost_leaves_no_steady_error() -> None:
    """Half the friction is not known: the integral action that the cost asks for makes up for it."""
    law = pi(dt=DT, torque_limit=73.5, friction_of=PLANT, **tuned_on_the_model().gains())
    rough = PLANT.with_parameters(coulomb=4.0)
    run = simulate(rough, law=law, dt=DT, delay=1, speed_reference=np.full(4000, 2.0))
    assert abs(run["speed_load"][-1] - 2.0) < 0.005


def test_a_drive_of_another_size() -> None:
    small = Drivetrain.two_mass(
        inertia_motor=3e-5, inertia_load=2e-4, stiffness=40.0, damping=2e-3, backlash=0.009, coulomb=4e-3,
        viscous=1e-4, lag=3e-4,
    )  # fmt: skip
    tuned = optimised_pi(small, dt=2.5e-4, torque_limit=0.6, speed=20.0, torque_load=0.05)
    law = pi(dt=2.5e-4, torque_limit=0.6, friction_of=small, **tuned.gains())
    reference = np.where(np.arange(4000) < 1000, -20.0, 20.0)
    run = simulate(small, law=law, dt=2.5e-4, delay=1, speed_reference=reference)
    step = step_metrics(run.time, run["speed_load"], 0.25, -20.0, 20.0)
    assert step.overshoot < 10.0 and step.steady_error < 0.005 and tuned.sensitivity < 2.1


@pytest.mark.parametrize("name", ["torque_limit", "speed", "torque_load"])
def test_misuse(name: str) -> None:
    with pytest.raises(InvalidInput, match=f"optimised_pi.{name}"):
        optimised_pi(PLANT, **{**ASKED, name: 0.0})

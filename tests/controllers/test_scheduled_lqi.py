"""Scheduled LQI: the law of ``lqi`` at each load inertia, steady states between them, the gate, contracts."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.controllers import lqi, scheduled_lqi
from lostmotion.drivetrain import Drivetrain, Friction
from lostmotion.errors import InvalidInput
from lostmotion.kernels import scheduled_feedback
from lostmotion.systems import Stepper, design_model, steady_state

DT, LIMIT = 1e-4, 73.5
SMOOTH = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, viscous=0.0175,
    coulomb=2.0, lag=3e-4,
)  # fmt: skip
PLANT = replace(SMOOTH, frictions=(Friction((0.4, 0.1), 0.003), SMOOTH.frictions[1]))
WISHES = {
    "dt": DT,
    "largest_error": 2.0,
    "largest_oscillation": 4.0,
    "largest_torque": LIMIT,
    "torque_limit": LIMIT,
}
LAW = scheduled_lqi(PLANT, **WISHES)


def drawn(count, inertia, seed=1):
    """Signals of a law that is mostly within its limit."""
    rng = np.random.default_rng(seed)
    sizes = {
        "speed_reference": 2.0, "twist_elastic_estimated": 2e-3, "speed_motor_estimated": 1.0,
        "speed_load_estimated": 1.0, "friction_load_estimated": 1.0, "torque_motor_acting": 10.0,
        "torque_load_estimated": 1.0,
    }  # fmt: skip
    signals = {name: size * rng.normal(size=count) for name, size in sizes.items()}
    return {**signals, "inertia_load_estimated": np.full(count, inertia)}


@pytest.mark.parametrize("lag", [0.0, 3e-4])
@pytest.mark.parametrize("factor", [0.5, 1.0, 2.0])
def test_at_a_constant_inertia_it_is_lqi(factor, lag):
    plant = PLANT.with_parameters(lag=lag)
    signals = drawn(4000, factor * PLANT.inertia_load)
    found = scheduled_lqi(plant, **WISHES).run(signals)["torque_motor"]
    fixed = lqi(plant.with_parameters(inertia_load=factor * PLANT.inertia_load), **WISHES)
    wanted = fixed.run({name: signals[name] for name in fixed.inputs})["torque_motor"]
    # After the gate has gone all the way; factors of two are points of the table.
    np.testing.assert_allclose(found[1000:], wanted[1000:], rtol=0.0, atol=1e-8)
    assert np.mean(np.abs(wanted) < LIMIT) > 0.3 and np.ptp(wanted) == 2.0 * LIMIT


@pytest.mark.parametrize("factor", [0.3, 0.9, 1.13, 3.7])
def test_between_the_points_a_steady_state_is_held_too(factor):
    loaded = PLANT.with_parameters(inertia_load=factor * PLANT.inertia_load)
    model, speed, pull = design_model(loaded, DT), 3.0, -6.0
    # The friction's estimate carries its viscous part; the motor's Coulomb friction is that of the set-point.
    held = steady_state(loaded, model, speed, pull)
    state = dict(zip(model.states, held.state, strict=True))
    motor, load = PLANT.frictions
    shaft = PLANT.viscous * speed + load.coulomb_plus - pull
    torque = shaft + PLANT.viscous_motor * speed + motor.coulomb_plus
    signals = {
        "speed_reference": speed, "twist_elastic_estimated": shaft / PLANT.stiffness,
        "speed_motor_estimated": state["speed_motor"], "speed_load_estimated": state["speed_load"],
        "friction_load_estimated": load.coulomb_plus + PLANT.viscous * speed, "torque_motor_acting": torque,
        "torque_load_estimated": pull, "inertia_load_estimated": loaded.inertia_load,
    }  # fmt: skip
    found = LAW.run({name: np.full(4000, value) for name, value in signals.items()})["torque_motor"]
    assert found[-1] == pytest.approx(torque, abs=1e-9)


def test_the_gate_follows_a_jump_of_the_estimate_at_its_rate_and_stays_in_the_table():
    row = [signals[0] for signals in drawn(1, np.nan).values()]
    for wished, end in ((2.0, 2.0), (1e3, 4.0), (-1.0, 0.25)):
        state, inertias = LAW.init(), []
        for _ in range(2000):
            row[-1] = wished * PLANT.inertia_load
            state, _, _ = LAW.step(state, row)
            inertias.append(state[scheduled_feedback.INERTIA])
        changes = np.abs(np.diff(np.log(inertias)))
        assert np.max(changes) == pytest.approx(20.0 * DT, rel=2e-3)
        assert inertias[-1] == pytest.approx(end * PLANT.inertia_load)


@pytest.mark.parametrize("size", [1.0, 1e4, 1e30])
def test_never_beyond_the_limit_never_nan(size):
    rng = np.random.default_rng(3)
    rows = size * rng.normal(size=(2000, 8))
    rows[rng.random(rows.shape) < 0.05] = np.nan
    rows[rng.random(rows.shape) < 0.05] = np.inf
    torque = LAW.run(dict(zip(LAW.inputs, rows.T, strict=True)))["torque_motor"]
    assert np.all(np.abs(torque) <= LIMIT)


def test_the_same_law_after_json():
    again = Stepper.from_dict(json.loads(json.dumps(LAW.to_dict())))
    data = drawn(50, 0.15)
    assert again.run(data)["torque_motor"].tobytes() == LAW.run(data)["torque_motor"].tobytes()


def test_with_the_filter_that_tracks_the_load_inertia_half_a_load_does_not_overshoot():
    """And in the loop of a batch it does the same."""
    from lostmotion.compare.controllers.contestants import ADAPTIVE

    light = PLANT.with_parameters(inertia_load=0.5 * PLANT.inertia_load)
    observer = lm.observers.extended_kalman(PLANT, dt=DT, **ADAPTIVE)
    fixed = lqi(PLANT, **WISHES)
    steps = lm.signals.steps((0.1, 0.2, 0.3), (-2.0, 2.0, -2.0, 2.0), 0.4, DT)
    arguments = {
        "dt": DT, "delay": 1, "speed_reference": steps, "sensors": {"torque_motor_acting": lm.Sensor("torque_motor")},
        "state": (-0.006, -2.0, -2.0),
    }  # fmt: skip

    def overshoot(law):
        run = lm.simulate(light, law=[observer, law], **arguments)
        # In the last step, after the filter has seen two.
        return 25.0 * (np.max(run["speed_load"][3000:]) - 2.0), run

    (adaptive, run), (held, _) = overshoot(LAW), overshoot(fixed)
    assert adaptive < 2.0 and held > 6.0
    batch = lm.simulate_batch([light], law=[observer, LAW], workers=1, **arguments)
    assert batch.final_state[0].tolist() == list(run.final_state["state"][:3])


@pytest.mark.parametrize(
    "changes",
    [{"torque_limit": np.inf}, {"schedule_rate": 0.0}, {"schedule_rate": 2e4}, {"largest_error": -1.0}],
)
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=next(iter(changes))):
        scheduled_lqi(PLANT, **{**WISHES, **changes})

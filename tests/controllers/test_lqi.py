"""Linear-quadratic speed control: gains, steady state, load torque, limits, and a drive that gives less than asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.controllers import lqi, quadratic_feedback
from lostmotion.drivetrain import Drivetrain, Friction
from lostmotion.errors import InvalidInput
from lostmotion.metrics import crossing_metrics, recovery, step_metrics
from lostmotion.observers import kalman
from lostmotion.simulation import Sensor, simulate
from lostmotion.systems import DiscreteSystem, connect, design_model, one_sample_delay

DT = 1e-4
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip
WISHES = {"largest_error": 2.0, "largest_torque": 73.5}


def test_the_gain_is_where_the_riccati_recursion_ends():
    found = quadratic_feedback(PLANT, DT, **WISHES, largest_oscillation=3.0, largest_twist=0.02)
    model = design_model(PLANT, DT)
    error, slip, twist = (
        model.row(**{name: 1.0 for name in names} | {n: -1.0 for n in minus})
        for names, minus in ((["speed_load"], []), (["speed_motor"], ["speed_load"]), (["twist"], []))
    )
    q = np.outer(error, error) / 2.0**2 + np.outer(slip, slip) / 3.0**2 + np.outer(twist, twist) / 0.02**2
    p, a, b = np.zeros_like(q), model.A, model.B[:, None]
    for _ in range(5000):
        gain = (b.T @ p @ a) / (1.0 / 73.5**2 + b.T @ p @ b)
        p = q + a.T @ p @ (a - b @ gain)
    np.testing.assert_allclose(found.gain, gain[0], rtol=1e-8)
    assert found.states == model.states


def model_as_plant(drivetrain: Drivetrain) -> DiscreteSystem:
    """The design model with its states as an observer's outputs; the friction's estimate is its viscous part."""
    model = design_model(drivetrain, DT)
    n = len(model.states)
    names = ("twist_elastic_estimated", "speed_motor_estimated", "speed_load_estimated")
    signals = [*np.eye(n)[:3], drivetrain.viscous * model.row(speed_load=1.0), np.zeros(n)]
    signals.append(model.row(torque_last=1.0))
    return DiscreteSystem(
        inputs=("torque_motor", "torque_load"), states=model.states, dt=DT, name="plant",
        outputs=(*names, "friction_load_estimated", "torque_load_estimated", "torque_motor_acting"),
        A=model.A, B=np.column_stack([model.B, model.E]), C=np.array(signals),
        D=np.outer(np.eye(6)[4], [0.0, 1.0]),
    )  # fmt: skip


@pytest.mark.parametrize("lag", [0.0, 3e-4])
def test_set_point_and_load_torque_leave_no_error(lag):
    plant = PLANT.with_parameters(lag=lag, viscous_motor=0.01)
    law = connect(
        [model_as_plant(plant), lqi(plant, dt=DT, **WISHES)],
        inputs=("speed_reference", "torque_load"), outputs=("speed_load_estimated", "torque_motor"),
    )  # fmt: skip
    found = law.run({"speed_reference": np.full(6000, 3.0), "torque_load": np.full(6000, -10.0)})
    assert found["speed_load_estimated"][-1] == pytest.approx(3.0, rel=1e-10)
    assert found["torque_motor"][-1] == pytest.approx(10.0 + 3.0 * (0.0175 + 0.01), rel=1e-10)


def with_observer(drivetrain: Drivetrain, **changes) -> DiscreteSystem:
    observer = kalman(drivetrain, dt=DT, load_torque=True, process_covariance={"torque_load": 1e6})
    parts = [observer.renamed({"torque_motor": "torque_motor_acting"})]
    parts.append(lqi(drivetrain, dt=DT, **{**WISHES, "torque_limit": 73.5, **changes}))
    return connect(
        parts, inputs=("speed_reference", "speed_motor", "torque_motor_acting"), outputs=("torque_motor",)
    )


def run(law, plant=PLANT, n=8000, load=None, realised=True):
    """Step −2 → 2 rad/s at 0.3 s, with one sample of computing delay."""
    reference = np.where(np.arange(n) < 3000, -2.0, 2.0)
    sensors = {"torque_motor_acting": Sensor("torque_motor")}
    if not realised:
        delay = one_sample_delay("torque_motor", DT, "torque_motor_acting")
        law = connect([law, delay], inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))
        sensors = {}
    given = {} if load is None else {"torque_load": load}
    return simulate(plant, dt=DT, law=law, delay=1, sensors=sensors, speed_reference=reference, **given)


def test_step_and_load_step_across_the_gap():
    n = 12_000
    load = np.where(np.arange(n) < 6000, 0.0, -10.0)
    found = run(with_observer(PLANT), n=n, load=load)
    step = step_metrics(found.time, found["speed_load"], 0.3, -2.0, 2.0, stop_time=0.6)
    assert step.overshoot <= 1.0
    assert step.steady_error < 1e-4
    rejected = recovery(found.time, found["speed_load"] - 2.0, 0.6, 0.08)
    assert rejected.time < 0.060
    assert np.max(np.abs(found["speed_load"][-500:] - 2.0)) < 1e-3
    assert np.max(np.abs(found["torque_motor"])) <= 73.5


def test_without_weight_on_the_motor_s_oscillation_it_chatters_in_the_gap():
    crossings = {}
    for share in (4.0, np.inf):
        found = run(with_observer(PLANT, largest_oscillation=share))
        crossings[share] = crossing_metrics(
            found.time, found["speed_motor"], found["speed_load"], found.events, 0.3, -2.0, 2.0
        )
    assert crossings[4.0].impacts == 1
    assert crossings[np.inf].impacts >= 3


def test_a_drive_that_gives_less_than_asked_needs_the_realised_torque():
    weak = replace(PLANT, actuator=replace(PLANT.actuator, torque_limit=12.0))
    overshoot = {}
    for realised in (True, False):
        found = run(with_observer(PLANT), weak, realised=realised)
        overshoot[realised] = step_metrics(found.time, found["speed_load"], 0.3, -2.0, 2.0).overshoot
    assert overshoot[True] < 1.0 < overshoot[False]


def test_friction_of_the_motor_is_compensated_by_the_set_point():
    plant = replace(PLANT, frictions=(Friction((1.0, 0.5), 0.01), PLANT.frictions[1]))
    found = run(with_observer(plant), plant)
    assert found["speed_load"][2999] == pytest.approx(-2.0, abs=2e-3)
    assert found["speed_load"][-1] == pytest.approx(2.0, abs=2e-3)


def test_without_load_torque_it_asks_for_none():
    law = lqi(PLANT, dt=DT, **WISHES, load_torque=False)
    assert "torque_load_estimated" not in law.inputs


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"largest_error": 0.0}, r"lqi\.largest_error"),
        ({"largest_torque": np.inf}, r"lqi\.largest_torque"),
        ({"largest_twist": -1.0}, r"lqi\.largest_twist"),
        ({"largest_oscillation": np.nan}, r"lqi\.largest_oscillation"),
        ({"torque_limit": 0.0}, r"lqi\.torque_limit"),
        ({"dt": 0.0}, "dt"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        lqi(PLANT, **{"dt": DT, **WISHES, **arguments})

"""State feedback: the paper's gains, exact poles, exact steady state, friction compensation, limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.controllers import pi, pole_placement, state_feedback
from lostmotion.drivetrain import Drivetrain, Friction
from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.systems import DiscreteSystem, connect, zero_order_hold

LINEAR = PAPER.with_parameters(backlash=0.0, coulomb=0.0, viscous_motor=0.003)
DT = 1e-4


def test_the_paper_s_gains_in_continuous_time():
    found = state_feedback(PAPER.with_parameters(viscous=0.0), poles=(-400.0, -400.0, -400.0))
    np.testing.assert_allclose(found.gain, [1345.88, 21.378, -0.80919], rtol=5e-6)
    assert found.prefilter == pytest.approx(20.5687, rel=2e-6)
    assert found.friction_gain == pytest.approx(1.2141, rel=1e-5)


@pytest.mark.parametrize("poles", [(-400, -300, -200), (-50, -300 + 200j, -300 - 200j)])
@pytest.mark.parametrize("dt", [None, 1e-4, 1e-3])
def test_the_poles_are_where_they_were_wanted(poles, dt):
    a, b = PAPER.linear()
    wanted = np.array(poles, dtype=complex)
    if dt is not None:
        a, b = zero_order_hold(a, b, dt)
        wanted = np.exp(wanted * dt)
    found = np.linalg.eigvals(a - b @ state_feedback(PAPER, poles, dt).gain[None, :])
    np.testing.assert_allclose(np.sort_complex(found), np.sort_complex(wanted), rtol=1e-6)


@pytest.mark.parametrize("poles", [(-400, -400, -400), (-400, -400, -100)])
@pytest.mark.parametrize("dt", [None, 1e-4, 1e-3])
def test_repeated_poles(poles, dt):
    """By the polynomial: rounding spreads the eigenvalues of a repeated pole by its third root."""
    a, b = PAPER.linear()
    wanted = np.array(poles, dtype=float)
    if dt is not None:
        a, b = zero_order_hold(a, b, dt)
        # As (z − 1)/dt: near 1 the coefficients of z would hide the poles.
        a, b, wanted = (a - np.eye(3)) / dt, b / dt, np.expm1(wanted * dt) / dt
    found = a - b @ state_feedback(PAPER, poles, dt).gain[None, :]
    np.testing.assert_allclose(np.poly(found), np.poly(wanted), rtol=1e-6)


def model_as_plant(drivetrain: Drivetrain, dt: float, load: float = 0.0) -> DiscreteSystem:
    """The linear two-mass model with all states as outputs, and a constant friction torque of the load."""
    a, b = drivetrain.linear()
    friction = np.array([[0.0], [0.0], [-1.0 / drivetrain.inertia_load]])
    phi, gamma = zero_order_hold(a, np.hstack([b, friction]), dt)
    names = ("twist_elastic_estimated", "speed_motor_estimated", "speed_load_estimated")
    return DiscreteSystem(
        inputs=("torque_motor", "coulomb"), outputs=(*names, "friction_load_estimated"),
        states=names, dt=dt, A=phi, B=gamma, C=np.vstack([np.eye(3), [[0.0, 0.0, drivetrain.viscous]]]),
        D=[[0.0, 0.0]] * 3 + [[0.0, 1.0]], name="plant",
    )  # fmt: skip


@pytest.mark.parametrize("dt", [1e-4, 1e-3])
def test_the_linear_steady_state_is_exact(dt):
    plant = model_as_plant(LINEAR, dt)
    law = connect(
        [plant, pole_placement(LINEAR, dt=dt)],
        inputs=("speed_reference", "coulomb"), outputs=("speed_load_estimated", "torque_motor"),
    )  # fmt: skip
    n = round(0.3 / dt)
    found = law.run({"speed_reference": np.full(n, 3.0), "coulomb": np.full(n, 2.0)})
    assert found["speed_load_estimated"][-1] == pytest.approx(3.0, rel=1e-12)
    assert found["torque_motor"][-1] == pytest.approx(
        2.0 + 3.0 * (LINEAR.viscous + LINEAR.viscous_motor), rel=1e-12
    )


def step_with(controller, drivetrain, seconds=0.6, at=0.3, levels=(-2.0, 2.0), observer=True):
    """Load speed and torque of a set-point step; the plant is its own model at a twentieth of the sample."""
    fine = 20
    plant = connect(
        [kalman(drivetrain, dt=DT / fine).renamed({"speed_motor": "speed_motor_estimated"})],
        inputs=("torque_motor",), outputs=("speed_motor_estimated", "speed_load_estimated"),
    )  # fmt: skip
    law = controller
    if observer:
        law = connect(
            [kalman(drivetrain, dt=DT), controller],
            inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",),
        )  # fmt: skip
    return run_loop(plant, law, fine, round(seconds / DT), round(at / DT), levels)


def run_loop(plant, law, fine, n, at, levels):
    from lostmotion.kernels.law.step import law_step

    tables = [plant.tables(), law.tables()]
    states = [s.init() for s in (plant, law)]
    torque, speeds, inputs = np.zeros(1), np.zeros(2), np.zeros(2)
    load, torques = np.empty(n), np.empty(n)
    motor = plant.states.index("speed_motor")
    for k in range(n):
        inputs[:] = levels[0] if k < at else levels[1], states[0][motor]
        law_step(tables[1], states[1], inputs, torque)
        torques[k] = torque[0]
        for j in range(fine):
            law_step(tables[0], states[0], torque, speeds)
            if j == 0:
                load[k] = speeds[1]
    return load, torques


@pytest.mark.parametrize("compensation, peak", [("estimated", 75.6), ("reference", 80.2)])
def test_step_of_the_paper_with_observer_1(compensation, peak):
    load, torque = step_with(pole_placement(PAPER, dt=DT, friction_compensation=compensation), PAPER)
    assert load[2999] == pytest.approx(-2.0, abs=1e-4)
    assert load[-1] == pytest.approx(2.0, abs=1e-4)
    assert np.max(load) < 2.0 + 0.01 * 4.0
    assert np.max(torque) == pytest.approx(peak, abs=0.5)
    assert np.std(torque[-500:]) < 1e-4  # settling at the observer's slow pole, no chatter


def test_the_paper_s_peak_torques_with_its_continuous_gains(monkeypatch):
    import sys

    module = sys.modules["lostmotion.controllers.pole_placement"]
    monkeypatch.setattr(module, "state_feedback", lambda d, poles, dt=None: state_feedback(d, poles))
    for compensation, peak in (("estimated", 80.0), ("reference", 85.0)):
        _, torque = step_with(pole_placement(PAPER, dt=DT, friction_compensation=compensation), PAPER)
        assert np.max(torque) == pytest.approx(peak, abs=0.5)


def test_pi_overshoots_as_in_the_paper():
    load, torque = step_with(pi(dt=DT), PAPER, seconds=0.9, at=0.5, observer=False)
    assert (np.max(load) - 2.0) / 4.0 == pytest.approx(0.086, abs=0.003)
    assert np.max(torque[5000:]) == pytest.approx(38.0, abs=0.3)


def test_feeding_back_the_whole_twist_would_leave_the_load_below_the_set_point():
    controller = pole_placement(PAPER, dt=DT).renamed({"twist_elastic_estimated": "twist_estimated"})
    load, _ = step_with(controller, PAPER)
    gains = state_feedback(PAPER, dt=DT)
    assert load[-1] == pytest.approx(2.0 - gains.gain[0] * 0.006 / gains.prefilter, abs=1e-3)


def test_without_compensation_the_load_stays_below_the_set_point():
    load, _ = step_with(pole_placement(PAPER, dt=DT, friction_compensation="none"), PAPER)
    # friction gain · 2 Nm / prefilter
    gains = state_feedback(PAPER, dt=DT)
    assert load[-1] == pytest.approx(2.0 - 2.0 * gains.friction_gain / gains.prefilter, abs=1e-3)


def test_the_load_comes_to_rest_at_a_set_point_of_zero():
    load, torque = step_with(pole_placement(PAPER, dt=DT), PAPER, levels=(2.0, 0.0))
    assert np.min(load) > -0.02
    assert np.max(np.abs(load[-500:])) < 1e-9
    assert np.ptp(torque[-500:]) < 1e-6


def test_the_torque_limit_holds_and_the_observer_knows_it():
    load, torque = step_with(pole_placement(PAPER, dt=DT, torque_limit=30.0), PAPER)
    assert np.max(np.abs(torque)) == 30.0
    assert np.sum(torque == 30.0) > 50
    assert load[-1] == pytest.approx(2.0, abs=1e-3)


def test_one_sided_friction_and_friction_of_the_motor():
    plant = replace(PAPER, frictions=(Friction(0.4, 0.002), Friction((2.5, 1.0), 0.0175)))
    for compensation in ("estimated", "reference"):
        law = pole_placement(plant, dt=DT, friction_compensation=compensation)
        load, _ = step_with(law, plant)
        assert load[2999] == pytest.approx(-2.0, abs=1e-3)
        assert load[-1] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"poles": (-400, -400)}, "three numbers"),
        ({"poles": (-400, -400 + 10j, -400 + 10j)}, "conjugate"),
        ({"poles": (-400, -400, 0.0)}, "negative real parts"),
        ({"poles": (-400, -400, float("nan"))}, "poles"),
        ({"torque_limit": 0.0}, "torque_limit"),
        ({"friction_compensation": "sign"}, "friction_compensation"),
        ({"dt": 0.0}, "dt"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        pole_placement(PAPER, **{"dt": DT, **arguments})

"""Predictive control: the optimum of an independent solver, the quadratic law within the limit, the limit beyond."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from lostmotion.controllers import predictive, quadratic_feedback
from lostmotion.controllers.feedback.feedback_law import wished_rows
from lostmotion.controllers.planning.plan_cost import move_lengths
from lostmotion.controllers.predictive import MOVES, closed_plan
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.systems import design_model

DT, LIMIT = 1e-4, 73.5
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip
WISHES = {"largest_error": 1.0, "largest_oscillation": 4.0, "largest_torque": LIMIT}
LAW = predictive(PLANT, dt=DT, torque_limit=LIMIT, **WISHES)


def answer(law, state, **others):
    """The torque at a state (twist, both speeds, actuator, last torque), everything else zero."""
    names = (
        "twist_elastic_estimated",
        "speed_motor_estimated",
        "speed_load_estimated",
        "torque_motor_acting",
    )
    signals = dict.fromkeys(law.inputs, 0.0) | dict(zip(names, np.delete(state, 3), strict=True)) | others
    return law.step(law.init([state[3]]), [signals[name] for name in law.inputs])[1][0]


def states(count, seed=1):
    return np.random.default_rng(seed).normal(size=(count, 5)) * [0.004, 1.5, 1.5, 25.0, 25.0]


def test_the_first_move_is_that_of_an_independent_solver():
    model = design_model(PLANT, DT)
    rows = wished_rows("", model, 2.0, LIMIT, 4.0, np.inf)
    law = predictive(PLANT, dt=DT, torque_limit=LIMIT, passes=32, **{**WISHES, "largest_error": 2.0})
    plan = closed_plan(
        model, rows, 1.0 / LIMIT**2, move_lengths(round(1.5 / (PLANT.pole_frequency * DT)), MOVES)
    )
    root = np.linalg.cholesky(plan.hessian).T
    touched = 0
    # Far out, where the limit binds later moves while the first is still free.
    for state in 2.0 * states(300):
        # Viscous friction at the present speed is no Coulomb friction: the observer tells it so.
        given = {"friction_load_estimated": PLANT.viscous * state[2]}
        gradient = plan.state_gradient @ state
        best = lsq_linear(root, -np.linalg.solve(root.T, gradient), bounds=(-LIMIT, LIMIT), tol=1e-13).x
        clipped = np.clip(-np.linalg.solve(plan.hessian, gradient)[0], -LIMIT, LIMIT)
        touched += abs(clipped - best[0]) > 1.0
        assert answer(law, state, **given) == pytest.approx(best[0], abs=0.01)
    assert touched > 4


def test_with_a_move_for_each_sample_and_no_limit_it_is_the_quadratic_law():
    model = design_model(PLANT, DT)
    plan = closed_plan(model, wished_rows("", model, 1.0, LIMIT, 4.0, np.inf), LIMIT**-2, (1,) * 30)
    first = np.linalg.solve(plan.hessian, plan.state_gradient)[0]
    np.testing.assert_allclose(first, quadratic_feedback(PLANT, DT, **WISHES).gain, rtol=1e-7)


@pytest.mark.parametrize("friction, pull", [(2.0, 0.0), (-1.5, 8.0), (0.0, -20.0)])
def test_a_steady_state_is_held(friction, pull):
    speed = 3.0
    shaft = friction + PLANT.viscous * speed - pull
    state = np.array([shaft / PLANT.stiffness, speed, speed, shaft, shaft])
    told = {"friction_load_estimated": friction + PLANT.viscous * speed, "torque_load_estimated": pull}
    assert answer(LAW, state, speed_reference=speed, **told) == pytest.approx(shaft, abs=1e-6)


def test_the_cost_falls_with_every_pass():
    model = design_model(PLANT, DT)
    plan = closed_plan(
        model, wished_rows("", model, 0.5, LIMIT, 4.0, np.inf), LIMIT**-2, move_lengths(150, 8)
    )
    for state in states(50, seed=3):
        gradient = plan.state_gradient @ state
        moves = np.clip(-np.linalg.solve(plan.hessian, gradient), -LIMIT, LIMIT)
        costs = []
        for _ in range(6):
            for i in reversed(range(8)):
                step = (plan.hessian[i] @ moves + gradient[i]) / plan.hessian[i, i]
                moves[i] = np.clip(moves[i] - step, -LIMIT, LIMIT)
            costs.append(0.5 * moves @ plan.hessian @ moves + gradient @ moves)
        assert np.all(np.diff(costs) <= 1e-9 * abs(costs[0]))


@pytest.mark.parametrize("horizon, moves", [(150, 8), (150, 1), (5, 8), (1, 1)])
def test_moves_fill_the_horizon(horizon, moves):
    lengths = move_lengths(horizon, moves)
    assert min(lengths) >= 1 and sum(lengths) >= min(horizon, moves)
    assert list(lengths) == sorted(lengths)


@pytest.mark.parametrize(
    "changes", [{"moves": 0}, {"passes": 1.5}, {"torque_limit": np.inf}, {"largest_error": -1.0}]
)
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"predictive.{next(iter(changes))}"):
        predictive(PLANT, dt=DT, **{"torque_limit": LIMIT, **WISHES, **changes})

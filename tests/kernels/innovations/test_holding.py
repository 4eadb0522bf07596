"""An inertia that rests over a whole sample: against the exact simulation, and whether friction holds it."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.kernels.innovations.columns import WIDE
from lostmotion.kernels.innovations.delayed_torque import torque_at_ends
from lostmotion.kernels.innovations.holding import fill_loads, holds, stops
from lostmotion.kernels.innovations.motion import moved
from lostmotion.kernels.innovations.transitions import (
    BACKLASH,
    BLOCK,
    COULOMB,
    COULOMB_MOTOR,
    DAMPING,
    INERTIA_LOAD,
    INERTIA_MOTOR,
    NUMBERS,
    STIFFNESS,
    VISCOUS_MOTOR,
    fill_numbers,
    fill_transitions,
)

#: Eight samples in the torsional period.
DT, KIND = 1.25e-3, (False, 0, False, False, False)
MOTOR, LOAD = 1, 2


def parameters(coulomb: float, coulomb_motor: float) -> np.ndarray:
    q = np.zeros(26)
    q[[INERTIA_MOTOR, INERTIA_LOAD, STIFFNESS, DAMPING]] = 0.0182, 0.111, 6285.896, 0.397
    q[[BACKLASH, COULOMB, COULOMB_MOTOR, VISCOUS_MOTOR]] = 0.012, coulomb, coulomb_motor, 0.004
    return q


def drivetrain(q: np.ndarray) -> lm.Drivetrain:
    return lm.Drivetrain.two_mass(
        inertia_motor=q[INERTIA_MOTOR], inertia_load=q[INERTIA_LOAD], stiffness=q[STIFFNESS], damping=q[DAMPING],
        backlash=q[BACKLASH], coulomb=q[COULOMB], coulomb_motor=q[COULOMB_MOTOR], viscous_motor=q[VISCOUS_MOTOR],
    )  # fmt: skip


def rested(
    q: np.ndarray, stuck: int, state: tuple[float, float, float], torque: float
) -> tuple[np.ndarray, bool]:
    """State after a sample in which what is stuck rests, and whether friction holds it."""
    table, numbers, loads = np.zeros(2 * BLOCK), np.zeros(NUMBERS), np.zeros((3, 2, 2, 2, WIDE + 5))
    fill_transitions(q, DT, 0, 0, KIND, 1.0, stuck, table, np.zeros(0))
    fill_numbers(q, DT, 0, 0, 1.0, numbers)
    fill_loads(q, DT, 0, KIND, loads)
    contact = int(np.sign(state[0])) if abs(state[0]) > 0.5 * q[BACKLASH] else 0
    x, y, edge, closed = np.zeros(WIDE), np.zeros(WIDE), contact * 0.5 * q[BACKLASH], abs(contact)
    x[:3] = state
    assert moved(table, closed * BLOCK, numbers, 0, 4, x, torque, 0.0, edge, stuck, y) == stuck
    return y, holds(loads, closed, stuck, numbers, x, torque, y, torque, edge, 1.0)


@pytest.mark.parametrize(
    ("stuck", "state", "torque"),
    [
        (LOAD, (0.0062, 1.5, 0.0), 1.0), (LOAD, (-0.0063, -1.0, 0.0), 0.5), (LOAD, (0.001, 2.0, 0.0), -3.0),
        (MOTOR, (0.0075, 0.0, 0.3), 2.0), (MOTOR | LOAD, (0.0062, 0.0, 0.0), 1.0),
    ],
    ids=["load", "backwards", "load in the gap", "motor", "both"],
)  # fmt: skip
def test_a_sample_at_rest_ends_where_the_exact_one_does(
    stuck: int, state: tuple[float, float, float], torque: float
):
    q = parameters(40.0 if stuck & LOAD else 0.0, 40.0 if stuck & MOTOR else 0.0)
    y, held = rested(q, stuck, state, torque)
    run = lm.simulate(drivetrain(q), torque_motor=np.full(2, torque), dt=DT, state=state)
    exact = [run["twist"][1], run["speed_motor"][1], run["speed_load"][1]]
    assert held
    assert y[:3] == pytest.approx(exact, rel=1e-7, abs=1e-10)


@pytest.mark.parametrize("stuck", [MOTOR, LOAD], ids=["motor", "load"])
def test_what_breaks_away_is_not_held(stuck: int):
    """Wherever friction is said to hold, the exact drive rests (to 1e-4 rad/s); and so it is for most that do."""
    rng, said, rests = np.random.default_rng(3), [], []
    for _ in range(300):
        level = float(rng.uniform(1.0, 12.0))
        q = parameters(*((0.0, level) if stuck == MOTOR else (level, 0.0)))
        speed, torque = rng.uniform(-1.0, 1.0), rng.uniform(-10.0, 10.0)
        twist = rng.choice([-1.0, 1.0]) * (0.006 + rng.uniform(2e-4, 1.5e-3))
        state = (twist, 0.0, speed) if stuck == MOTOR else (twist, speed, 0.0)
        run = lm.simulate(drivetrain(q), torque_motor=np.full(41, torque), dt=DT / 40, state=state)
        own = run["speed_motor" if stuck == MOTOR else "speed_load"]
        if np.all(np.sign(run["twist"]) * run["twist"] > 0.006):
            said.append(rested(q, stuck, state, torque)[1])
            rests.append(bool(np.max(np.abs(own)) < 1e-4))
    assert sum(rests) > 60
    assert not any(one and not other for one, other in zip(said, rests, strict=True))
    assert sum(said) > 0.7 * sum(rests)


def test_what_moves_too_fast_to_stop_at_once_does_not_rest():
    q = parameters(2.0, 0.0)
    table, numbers, x = np.zeros(2 * BLOCK), np.zeros(NUMBERS), np.zeros(WIDE)
    fill_transitions(q, DT, 0, 0, KIND, 1.0, 0, table, np.zeros(0))
    fill_numbers(q, DT, 0, 0, 1.0, numbers)
    at_once = 2.0 * DT / q[INERTIA_LOAD] / 16.0
    for speed, expected in ((0.9 * at_once, True), (-0.9 * at_once, True), (1.1 * at_once, False)):
        x[2] = speed
        assert stops(table, 0, numbers, LOAD, x) is expected
    x[1] = 1.0  # the motor has no friction that could stop it, but is not said to rest
    x[2] = 0.0
    assert stops(table, 0, numbers, LOAD, x) and not stops(table, 0, numbers, MOTOR, x)


@pytest.mark.parametrize("ramp", [False, True], ids=["held torque", "ramp"])
def test_the_torque_at_the_ends_of_a_sample(ramp: bool):
    first, last = torque_at_ends(3.0, 2.0, 0.25, ramp)
    assert (first, last) == ((4.0, 2.0) if ramp else (4.5, 2.5))
    assert torque_at_ends(3.0, 2.0, 0.0, False) == (3.0, 3.0)

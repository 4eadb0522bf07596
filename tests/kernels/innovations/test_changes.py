"""Motion over a sample with changes in it, against the exact simulation."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.kernels.innovations.changes import along_path, through_changes
from lostmotion.kernels.innovations.columns import WIDE
from lostmotion.kernels.innovations.holding import fill_loads
from lostmotion.kernels.innovations.sample_parts import parts
from lostmotion.kernels.innovations.transitions import (
    BACKLASH,
    BLOCK,
    COULOMB,
    DAMPING,
    INERTIA_LOAD,
    INERTIA_MOTOR,
    NUMBERS,
    STIFFNESS,
    VISCOUS,
    fill_model,
    fill_transitions,
)

PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175,
)  # fmt: skip
DT, FINEST = 1e-3, 9
#: Speed from which the load comes to rest within a sample, rad/s.
COULOMB_ALONE = 0.004


MODEL, KIND = 2 * parts(FINEST) * BLOCK, (False, 0, False, False, False)


def values(**changed: float) -> np.ndarray:
    q = np.zeros(26)
    q[[INERTIA_MOTOR, INERTIA_LOAD]] = 0.0182, 0.111
    q[[STIFFNESS, DAMPING, BACKLASH, COULOMB, VISCOUS]] = 6285.896, 0.397, 0.012, 2.0, 0.0175
    q[COULOMB] = changed.get("coulomb", 2.0)
    return q


class Sample:
    """A sample of the plant's motion, from change to change."""

    def __init__(self, q: np.ndarray) -> None:
        models, self.numbers = np.zeros((4, MODEL)), np.zeros(NUMBERS)
        fill_model(q, DT, 0, FINEST, KIND, 1.0, models[0], self.numbers, np.zeros(2 * WIDE * WIDE))
        self.table, self.loads = models.reshape(-1), np.zeros((3, 2, 2, 2, WIDE + 5))
        for stuck in range(1, 4):
            fill_transitions(q, DT, 0, FINEST, KIND, 1.0, stuck, models[stuck], np.zeros(0))
        fill_loads(q, DT, 0, KIND, self.loads)
        self.filled = np.ones(4, dtype=np.bool_)

    def ends(self, state: tuple[float, float, float], torque: float, rest: int = 0):
        """State at the end, errors on the way, pieces, what rests then and what transition is lacking."""
        x, y, f, work = np.zeros(WIDE), np.zeros(WIDE), np.zeros(WIDE**2), np.zeros(WIDE**2 + WIDE)
        path = np.zeros((1 << FINEST, 4), dtype=np.int64)
        x[:3] = state
        contact = int(np.sign(state[0])) if abs(state[0]) > 0.006 else 0
        _, rest, _, pieces, lacking = through_changes(
            self.table, self.filled, MODEL, self.numbers, self.loads, FINEST, False, 4, (1, 2), 0,
            torque, 0.0, contact, rest, x, y, f, work, path,
        )  # fmt: skip
        return x[:3], f, path[:pieces], rest, lacking

    def along(self, path: np.ndarray, state: tuple[float, float, float], torque: float) -> np.ndarray:
        x, y = np.zeros(WIDE), np.zeros(WIDE)
        x[:3] = state
        contact = int(np.sign(state[0])) if abs(state[0]) > 0.006 else 0
        along_path(
            self.table, 0, MODEL, self.numbers, 0, FINEST, False, 4, (1, 2), 0, torque, 0.0, contact,
            path, len(path), x, y,
        )  # fmt: skip
        return x[:3]


def exactly(plant: lm.Drivetrain, state: tuple[float, float, float], torque: float) -> list[float]:
    run = lm.simulate(plant, torque_motor=np.full(2, torque), dt=DT, state=state)
    return [run["twist"][1], run["speed_motor"][1], run["speed_load"][1]]


@pytest.mark.parametrize(
    ("twist", "motor", "load", "torque"),
    [(0.0055, 2.0, 0.0, 5.0), (0.007, -3.0, 2.0, -4.0), (0.0, 1.0, 0.004, 0.0), (0.0, 0.3, -0.004, 1.0)],
    ids=["impact", "parting", "load comes to rest", "load comes to rest backwards"],
)
def test_a_sample_with_a_change_ends_where_the_exact_one_does(
    twist: float, motor: float, load: float, torque: float
):
    sample, state = Sample(values()), (twist, motor, load)
    x, f, path, _, _ = sample.ends(state, torque)
    assert x == pytest.approx(exactly(PLANT, state, torque), rel=1e-4, abs=1e-5)
    assert sample.along(path, state, torque) == pytest.approx(x, rel=1e-12)
    assert path[:, 1].sum() == 1 << FINEST and len(path) < 20
    if COULOMB_ALONE not in (load, -load):  # a friction that ends jumps: there the change itself moves
        step = 1e-7
        moved = sample.ends((twist, motor + step, load), torque)[0]
        assert (moved - x) / step == pytest.approx(f[WIDE : WIDE + 3], rel=0.01, abs=1e-5)


def test_what_rests_breaks_away_when_the_exact_one_does():
    """A load that friction holds at first, and the spring winds up."""
    state, torque = (0.00605, 1.0, 0.0), 3.0
    sample = Sample(values())
    x, _, path, rest, _ = sample.ends(state, torque, rest=2)
    assert path[0, 1] >= 64 and path[0, 2] == 2 and rest == 0
    assert x == pytest.approx(exactly(PLANT, state, torque), rel=1e-4, abs=1e-5)


def test_other_parameters_follow_the_same_pieces():
    state, torque, step = (0.0055, 2.0, 0.0), 5.0, 1e-6
    x, _, path, _, _ = Sample(values()).ends(state, torque)
    other = Sample(values(coulomb=2.0 + step))
    along, anew = other.along(path, state, torque), other.ends(state, torque)[0]
    assert (along - x) / step == pytest.approx((anew - x) / step, rel=1e-4, abs=1e-7)
    assert np.any(along != x)


def test_transitions_at_rest_that_are_missing_are_asked_for():
    sample = Sample(values())
    sample.filled[:] = False
    assert sample.ends((0.0, 1.0, 0.004), 0.0)[-1] == 2

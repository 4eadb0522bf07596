"""Motion over a sample with changes in it, against the exact simulation."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.kernels.innovations.contact_switching import _held
from lostmotion.kernels.innovations.motion import through_changes
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
    WIDE,
    fill_model,
)

PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175,
)  # fmt: skip
DT, FINEST = 1e-3, 9
#: Speed from which the load comes to rest within a sample, rad/s.
COULOMB_ALONE = 0.004


@pytest.mark.parametrize(
    ("twist", "motor", "load", "torque"),
    [(0.0055, 2.0, 0.0, 5.0), (0.007, -3.0, 2.0, -4.0), (0.0, 1.0, 0.004, 0.0), (0.0, 0.3, -0.004, 1.0)],
    ids=["impact", "parting", "load comes to rest", "load comes to rest backwards"],
)
def test_a_sample_with_a_change_ends_where_the_exact_one_does(
    twist: float, motor: float, load: float, torque: float
):
    q = np.zeros(23)
    q[[INERTIA_MOTOR, INERTIA_LOAD]] = 0.0182, 0.111
    q[[STIFFNESS, DAMPING, BACKLASH, COULOMB, VISCOUS]] = 6285.896, 0.397, 0.012, 2.0, 0.0175
    table, numbers, noise = np.zeros(2 * (FINEST + 1) * BLOCK), np.zeros(NUMBERS), np.zeros(2 * WIDE * WIDE)
    fill_model(q, DT, 0, FINEST, (False, False, False, False, False), 1.0, table, numbers, noise)
    x, y, f, work = np.zeros(WIDE), np.zeros(WIDE), np.zeros(WIDE * WIDE), np.zeros(WIDE * WIDE + WIDE)
    x[:3] = twist, motor, load
    contact = 1 if twist > 0.006 else 0
    through_changes(
        table, 0, numbers, 0, FINEST, _held(q, DT, FINEST), False, 4, (1, 2), 0, torque, 0.0, contact, 0, x, y,
        True, f, work,
    )  # fmt: skip
    run = lm.simulate(PLANT, torque_motor=np.full(2, torque), dt=DT, state=(twist, motor, load))
    exact = [run["twist"][1], run["speed_motor"][1], run["speed_load"][1]]
    assert x[:3] == pytest.approx(exact, rel=1e-4, abs=1e-5)
    if COULOMB_ALONE not in (load, -load):  # a friction that ends jumps: there the change itself moves
        step, moved = 1e-7, np.zeros(WIDE)
        moved[:3] = twist, motor + step, load
        through_changes(
            table, 0, numbers, 0, FINEST, _held(q, DT, FINEST), False, 4, (1, 2), 0, torque, 0.0, contact, 0, moved, y,
            False, f, work,
        )  # fmt: skip
        assert (moved - x)[:3] / step == pytest.approx(f[WIDE : WIDE + 3], rel=0.01, abs=1e-5)

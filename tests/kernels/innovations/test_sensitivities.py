"""How the parameters move the state within a sample: against differences of whole motions."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.kernels.innovations.columns import WIDE
from lostmotion.kernels.innovations.delayed_torque import delayed
from lostmotion.kernels.innovations.gap_in_doubt import blend, mean_gap
from lostmotion.kernels.innovations.motion import moved
from lostmotion.kernels.innovations.sample_parts import parts
from lostmotion.kernels.innovations.sensitivities import COLUMNS, fill_changes, follow, slides
from lostmotion.kernels.innovations.transitions import (
    BACKLASH,
    BLOCK,
    COMPLIANCE,
    COULOMB,
    COULOMB_MOTOR,
    DAMPING,
    DELAY,
    FADE,
    FADE_MOTOR,
    HALF,
    INERTIA_LOAD,
    INERTIA_MOTOR,
    LAG,
    LEAD,
    LOSS,
    NUMBERS,
    RISE,
    RISE_MOTOR,
    SHARE,
    STIFFNESS,
    TORQUE_OFFSET,
    TORQUE_RATE,
    VISCOUS,
    VISCOUS_MOTOR,
    fill_model,
)

DT, FINEST, STEP = 1e-3, 4, 1e-7
WHOLE = parts(FINEST) * BLOCK
VALUES = {
    INERTIA_MOTOR: 0.0182, INERTIA_LOAD: 0.111, STIFFNESS: 6285.896, DAMPING: 0.397, BACKLASH: 0.012, COULOMB: 2.0,
    VISCOUS: 0.0175, COULOMB_MOTOR: 0.5, VISCOUS_MOTOR: 0.004, LAG: 8e-4, DELAY: 1.3e-3,
    TORQUE_OFFSET: 0.7, SHARE: 0.3, COMPLIANCE: 0.4, LOSS: 1.5, TORQUE_RATE: 1.0,
}  # fmt: skip
#: All but the rate of the load torque, which is there for its state alone.
FREE = [*(place for place in VALUES if place != TORQUE_RATE), RISE, FADE, RISE_MOTOR, FADE_MOTOR]
TORQUE = np.array([1.0, -2.0, 3.0, 0.5, 4.0])


def models(parameters: np.ndarray, step: float, ramp: bool) -> tuple[np.ndarray, np.ndarray]:
    """Transitions and numbers as they are, then with each of the free parameters larger by a share ``step``."""
    tables, numbers, noise = (
        np.zeros((len(FREE) + 1, 2 * WHOLE)),
        np.zeros((len(FREE) + 1, NUMBERS)),
        np.zeros(2 * WIDE * WIDE),
    )
    for j in range(len(FREE) + 1):
        q = parameters.copy()
        if j > 0:
            q[FREE[j - 1]] *= np.exp(step)
        fill_model(q, DT, 0, FINEST, (ramp, 0, False, False, False), 1.0, tables[j], numbers[j], noise)
    return tables, numbers


@pytest.mark.parametrize("rise", [0.0, 0.4], ids=["the same friction", "rising friction"])
@pytest.mark.parametrize("ramp", [False, True], ids=["held torque", "ramp"])
@pytest.mark.parametrize("deviation", [0.0, 0.002], ids=["known contact", "contact in doubt"])
@pytest.mark.parametrize("contact", [-1, 0, 1])
def test_they_are_those_of_whole_motions(contact: int, deviation: float, ramp: bool, rise: float):
    parameters = np.zeros(26)
    parameters[list(VALUES)] = list(VALUES.values())
    parameters[[RISE, RISE_MOTOR]], parameters[[FADE, FADE_MOTOR]] = rise, 2.0
    tables, numbers = models(parameters, STEP, ramp)
    t, c, n, k = tables.reshape(-1), numbers.reshape(-1), 7, 3
    x = np.zeros(WIDE)
    x[:7] = contact * 0.008 + 0.001, 3.0, -2.0, 0.002, 2.5, 0.4, 1.5
    # The third inertia sits before the gap.
    rate, travel = x[4] - x[2], 0.5 * (x[4] - x[2]) * DT

    def after(j: int) -> tuple[np.ndarray, float, float, float, float]:
        of, y, mixed = j * NUMBERS, np.zeros(WIDE), np.zeros(BLOCK)
        u, jump = delayed(TORQUE, k, c, of, ramp)
        at = j * 2 * WHOLE
        weight, edge = float(contact != 0), contact * c[of + HALF]
        if deviation > 0.0:
            weight, edge, _ = mean_gap(x[0] + c[of + LEAD] * rate + travel, c[of + HALF], deviation)
        blend(t, at, at + WHOLE, weight, mixed)
        moved(mixed, 0, c, of, n, x, u, jump, edge, 0, y)
        return y, u, jump, edge, weight

    y, u, jump, edge, weight = after(0)
    assert slides(x, y, 0)
    expected = np.array([(after(j + 1)[0] - y)[:n] / STEP for j in range(len(FREE))])

    changes, what = np.zeros((len(FREE), 2 * BLOCK)), np.zeros(len(FREE), dtype=np.int64)
    fill_changes(tables, numbers, WHOLE, STEP, changes, what)
    mixed, slope = np.zeros(BLOCK), np.zeros(len(FREE) * WIDE)
    blend(t, 0, WHOLE, weight, mixed)
    room = (np.zeros(COLUMNS), np.zeros(COLUMNS), np.zeros(COLUMNS), np.zeros(WIDE))
    follow(
        t, WHOLE, mixed, c, changes.reshape(-1), 0, what, n, TORQUE, k, ramp, x, 0, u, jump, edge, weight, contact,
        (deviation, rate, travel), STEP, room, slope,
    )  # fmt: skip
    found = slope.reshape(len(FREE), WIDE)[:, :n]
    assert np.all(
        np.any(expected != 0.0, axis=1) | np.isin(FREE, [BACKLASH, RISE, FADE, RISE_MOTOR, FADE_MOTOR])
    )
    assert found == pytest.approx(expected, rel=1e-4, abs=1e-6)

"""At a constant speed no law goes on swinging: the adaptive ones are gated, the sliding ones chatter within a bound."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion import observers
from lostmotion.compare.controllers import CASES, CONTESTANTS
from lostmotion.compare.controllers.cases import Case
from lostmotion.compare.controllers.contestants import Contestant
from lostmotion.compare.controllers.experiment import designed, experiment, run

CASE = {case.name: case for case in CASES}
ENTRY = {entry.name: entry for entry in CONTESTANTS}
ADAPTIVE = [entry.name for entry in CONTESTANTS if entry.name.startswith("adaptive")]


def swing(case, entry):
    """Peak to peak of torque (Nm) and load speed (rad/s) over the last 0.3 s, 0.3 s after the step."""
    data = experiment(case, 1)
    found = run(designed(entry, data), data)
    late = found.time >= 0.6
    return np.ptp(found["torque_motor"][late]), np.ptp(found["speed_load"][late])


@pytest.mark.parametrize("name", ADAPTIVE)
@pytest.mark.parametrize("case", ["stiffness −20 %", "stiffness +20 %"])
def test_adaptive_laws_come_to_rest_with_a_wrong_model(case, name):
    torque, speed = swing(CASE[case], ENTRY[name])
    assert torque < 1.0 and speed < 1e-3


def test_it_is_the_gate_that_keeps_them_from_a_limit_cycle():
    """The filter that tracks every parameter swings with the same law where the stiffness is a third too small."""
    wrong = Case("stiffness × 0.65", "", factors={"stiffness": 0.65})
    gated = ENTRY["adaptive LQI"]
    free = Contestant(
        "",
        "speed",
        gated.control,
        lambda s: observers.extended_kalman(s.model, dt=s.dt, speed_from_counts=True),
    )
    assert swing(wrong, gated)[1] < 1e-3 and swing(wrong, free)[1] > 0.05


@pytest.mark.parametrize("name, largest", [("sliding mode", 0.5), ("super-twisting", 10.0)])
@pytest.mark.parametrize("case", ["step", "rest, friction model × 1"])
def test_sliding_laws_chatter_within_a_bound(case, name, largest):
    """The layer of sliding mode leaves the encoder's noise; super-twisting may use half of its 20 Nm."""
    torque, speed = swing(CASE[case], ENTRY[name])
    assert torque < largest and speed < 0.05

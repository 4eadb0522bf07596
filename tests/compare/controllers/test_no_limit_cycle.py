"""At a constant speed no law goes on swinging: the adaptive ones are gated, the sliding ones chatter within a bound."""

from __future__ import annotations

from dataclasses import replace

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


#: The law and the case that go on swinging now and then: docs/choosing-a-controller.md.
NOT_ALWAYS = ("stiffness +20 %", "adaptive soft landing")


def swing(case, entry, **factors):
    """Peak to peak of torque (Nm) and load speed (rad/s) over the last 0.3 s, 0.3 s after the step."""
    data = experiment(case, 1)
    model = data.setting.model
    other = {name: factor * getattr(model, name) for name, factor in factors.items()}
    data = replace(data, setting=replace(data.setting, model=model.with_parameters(**other)))
    found = run(designed(entry, data), data)
    late = found.time >= 0.6
    return np.ptp(found["torque_motor"][late]), np.ptp(found["speed_load"][late])


PAIRS = [(case, name) for case in ("stiffness −20 %", "stiffness +20 %") for name in ADAPTIVE]


@pytest.mark.parametrize("case, name", [pair for pair in PAIRS if pair != NOT_ALWAYS])
def test_adaptive_laws_come_to_rest_with_a_wrong_model(case, name):
    torque, speed = swing(CASE[case], ENTRY[name])
    assert torque < 1.0 and speed < 1e-3


def test_soft_landing_with_too_stiff_a_model_comes_to_rest_on_nearly_all_landings():
    """13 of 320 do not (rigs 1 to 8, 2026-11-27): which ones depends on the last digits of the model."""
    rng = np.random.default_rng(0)
    case, law = (CASE[NOT_ALWAYS[0]], ENTRY[NOT_ALWAYS[1]])
    spread = {"backlash": 1e-3, "stiffness": 0.02}
    models = [{name: 1.0 + part * rng.standard_normal() for name, part in spread.items()} for _ in range(20)]
    assert sum(swing(case, law, **model)[0] > 1.0 for model in models) <= 2


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

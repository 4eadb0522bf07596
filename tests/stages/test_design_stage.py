"""The design of the laws: what counts as noise, what is not told, and when no law is handed out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lostmotion.drivetrain import Drivetrain
from lostmotion.metrics import step_metrics
from lostmotion.simulation import simulate
from lostmotion.stages.design import Design, _sensor_noise, design
from lostmotion.stages.law_task import LawTask, landing_of
from lostmotion.stages.material import Material, Settings
from lostmotion.stages.parameters import find_parameters
from lostmotion.stages.speed_step import PAPER_STEP
from lostmotion.stages.target_law import Poles

DRIVE = Drivetrain.two_mass(
    inertia_motor=0.018,
    inertia_load=0.11,
    stiffness=6000.0,
    damping=0.4,
    backlash=0.012,
    coulomb=2.0,
    lag=4e-4,
)
DT = 1e-4


@pytest.mark.parametrize("model_error", [0.0, 1.0])
def test_slow_innovations_are_no_noise(model_error: float) -> None:
    """Else a drive whose friction the model has not got a law of minutes, as one of the zoo did."""
    time = 1e-3 * np.arange(20_000)
    noise = 0.02 * np.random.default_rng(1).normal(size=time.size)
    assert _sensor_noise(model_error * np.sin(10.0 * time) + noise) == pytest.approx(0.02, rel=0.03)


def test_counts_are_noise() -> None:
    """Of an encoder: differences of rounding errors, √2 of a step over √12."""
    angle = np.cumsum(np.random.default_rng(2).normal(size=20_000))
    rounding = np.round(angle) - angle
    assert 1.0 < _sensor_noise(np.diff(rounding)) / np.sqrt(1.0 / 6.0) < 1.4


@pytest.mark.parametrize(
    ("noise", "unknown", "reason"),
    [
        (0.01, (), ""),
        (1.0, (), "51 % of the torque limit"),
        (0.01, ("backlash",), "does not tell where the gap ends"),
    ],
)
def test_soft_landing_is_left_out_where_it_would_chatter_or_miss_the_edge(
    noise: float, unknown: tuple[str, ...], reason: str
) -> None:
    """J/(lag + dt) is 36 Nm s/rad: a noise of 1 rad/s asks for half of 70 Nm and more."""
    poles = Poles((-100.0, -100.0, -100.0), "a test")
    task = LawTask(Settings(), DRIVE, DT, False, 70.0, noise, frozenset(unknown))
    law, skipped = landing_of(task, poles, PAPER_STEP)
    assert (law is None) == bool(reason) and reason in skipped and bool(reason) == bool(skipped)


def laws_for(known: dict[str, float], not_told: tuple[str, ...] = (), **settings: Any) -> Design:
    """The laws for a nameplate of which a recording did not tell some values."""
    material = Material(known, Settings(sample_time=DT, **settings), 1, False, None, None, {}, {})
    found = find_parameters(material)
    table = {name: dict(entry) for name, entry in found.table.items()}
    for name in not_told:
        table.setdefault(name, {"value": None})["source"] = "not excited"
    return design(material, replace(found, table=table))


KNOWN = {name: value for name, value in DRIVE.parameters().items() if value}
SHAPE = ("inertia_motor", "inertia_load", "stiffness", "lag")


def overshoot(laws: Design, plant: Drivetrain, name: str) -> float:
    law, step = getattr(laws, name), laws.step
    run = simulate(
        plant.with_parameters(torque_limit=laws.torque_limit), law=law, dt=DT, delay=1,
        speed_reference=step.reference(DT), state=(0.0, step.low, step.low),
    )  # fmt: skip
    found = step_metrics(run.time, run["speed_load"], step.start, step.low, step.high, stop_time=step.stop)
    assert found.settling_time is not None and found.steady_error < 0.005
    return found.overshoot


def test_a_drive_whose_backlash_nobody_knows_gets_laws_that_suit_any() -> None:
    laws = laws_for({n: v for n, v in KNOWN.items() if n != "backlash"}, torque_limit=70.0)
    assert laws.taken["not_told"]["value"] == ["backlash"]
    assert laws.landing is None and laws.problems == ()
    for backlash in (0.0, 0.004, 0.03):
        plant = DRIVE.with_parameters(backlash=backlash)
        assert max(overshoot(laws, plant, name) for name in ("pi", "law")) < 10.0


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_values_that_are_not_told_may_be_off(factor: float) -> None:
    """By a factor of two, with a lag of 2 ms: the default for known values has a third of the margin."""
    laws = laws_for({n: v for n, v in KNOWN.items() if n != "lag"}, SHAPE, torque_limit=70.0)
    off = {name: factor * getattr(DRIVE, name) for name in SHAPE[:3]}
    assert overshoot(laws, DRIVE.with_parameters(**off, lag=2e-3), "pi") < 10.0
    assert laws.pi_skipped == "" and laws.taken["pi_kp"]["value"] < laws_for(KNOWN).taken["pi_kp"]["value"]


def test_a_law_far_slower_than_pi_is_refused_with_the_reason() -> None:
    """Observer and state feedback need the values; PI does not."""
    laws = laws_for({n: v for n, v in KNOWN.items() if n != "lag"}, SHAPE, torque_limit=70.0)
    assert laws.pi is not None and laws.law is None and laws.landing is None
    assert "times slower than PI" in laws.skipped
    (problem,) = laws.problems
    assert "lag" in problem.remedy and "fixed = [...] under [identify]" in problem.remedy
    helped = laws_for(KNOWN, torque_limit=70.0)
    assert helped.law is not None and helped.problems == ()


def test_a_law_that_leaves_its_own_load_behind_is_refused() -> None:
    laws = laws_for(KNOWN, torque_limit=1.0)
    assert laws.pi is None and laws.law is None and laws.landing is None
    assert all("of the step left" in text for text in (laws.pi_skipped, laws.skipped))

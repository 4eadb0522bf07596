"""What the observers promise on the virtual rig, on few rigs; docs/benchmarks/observers.md has the table of twenty."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.compare import CASES, CONTESTANTS
from lostmotion.compare.experiment import experiment
from lostmotion.compare.scores import score

CASE = {case.name: case for case in CASES}
ENTRY = {entry.name: entry for entry in CONTESTANTS}
RIGS = (1, 2, 3)


def medians(names, case, seeds=RIGS, duration=1.5):
    """Median over rigs of every metric, by observer."""
    data = [experiment(case if not isinstance(case, str) else CASE[case], seed, duration) for seed in seeds]
    found = {}
    for name in names:
        scores = [score(ENTRY[name].make(d.drivetrain, d.sensing), d) for d in data]
        found[name] = {
            metric: float(np.median([s[metric] for s in scores]))
            for metric in ("speed_load", "torque_shaft", "f1_gap")
            if scores[0][metric] is not None
        }
    return found


def test_observer_1_and_the_naive_rows():
    found = medians(
        ("Observer 1", "motor speed", "without backlash", "without friction", "scheduled"), "nominal"
    )
    assert found["Observer 1"]["speed_load"] < 0.002
    assert found["Observer 1"]["torque_shaft"] < 0.015
    assert found["Observer 1"]["f1_gap"] > 0.9
    assert found["scheduled"]["f1_gap"] > max(0.95, found["Observer 1"]["f1_gap"])
    assert 0.1 < found["motor speed"]["speed_load"] < 0.2
    assert found["without backlash"]["speed_load"] > 10.0 * found["Observer 1"]["speed_load"]
    assert found["without friction"]["speed_load"] > 20.0 * found["Observer 1"]["speed_load"]


def test_after_identification():
    found = medians(("Observer 1", "extended Kalman", "scheduled"), "identified")
    assert found["Observer 1"]["speed_load"] < 0.002
    assert found["Observer 1"]["torque_shaft"] < 0.015
    assert found["Observer 1"]["f1_gap"] > 0.9
    assert found["extended Kalman"]["f1_gap"] > 0.95
    assert found["scheduled"]["f1_gap"] > 0.95


@pytest.mark.parametrize("case", [case.name for case in CASES if case.factors])
def test_any_one_parameter_off_by_20_percent(case):
    """For some fixed gain with a load-torque state; the shaft torque too, where it is measured."""
    found = medians(("load torque", "Observer 2, load torque"), case)
    assert found["load torque"]["speed_load"] < 0.025
    assert found["Observer 2, load torque"]["speed_load"] < 0.025
    assert found["Observer 2, load torque"]["torque_shaft"] < 0.025


@pytest.mark.parametrize("case", ["inertia_load −20 %", "load torque 3 Nm"])
def test_a_load_torque_state_makes_it_robust(case):
    found = medians(("Observer 1", "load torque", "H∞, load torque"), case)
    assert found["load torque"]["speed_load"] < 0.025
    assert found["load torque"]["speed_load"] < 0.75 * found["Observer 1"]["speed_load"]
    assert found["H∞, load torque"]["speed_load"] < 0.6 * found["Observer 1"]["speed_load"]


@pytest.mark.parametrize("noise, helps", [(1.0, True), (3.0, True), (10.0, False), (30.0, False)])
def test_the_torque_sensor_pays_only_if_it_is_quiet(noise, helps):
    case = replace(CASE["nominal"], torque_noise=noise)
    found = medians(("Observer 1", "Observer 2"), case)
    for signal in ("speed_load", "torque_shaft"):
        assert (found["Observer 2"][signal] < found["Observer 1"][signal]) == helps

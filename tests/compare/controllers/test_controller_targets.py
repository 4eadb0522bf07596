"""What the laws promise on the virtual rig, on few rigs; the leaderboard has the numbers of twenty."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.compare.controllers import CASES, CONTESTANTS
from lostmotion.compare.controllers.experiment import designed, experiment, run
from lostmotion.compare.controllers.scores import score

CASE = {case.name: case for case in CASES}
ENTRY = {entry.name: entry for entry in CONTESTANTS}
RIGS = (1, 2)


def medians(case, *names, rigs=RIGS):
    """Median over rigs of every metric, by law."""
    found = {}
    for name in names:
        data = [experiment(CASE[case], seed) for seed in rigs]
        scores = [score(run(designed(ENTRY[name], d), d), d) for d in data]
        found[name] = {
            m: float(np.median([s[m] for s in scores])) for m in scores[0] if scores[0][m] is not None
        }
    return found if len(names) > 1 else found[names[0]]


def test_a_tip_in_with_soft_landing_is_faster_than_any_ramp_of_equal_jerk():
    ramp, soft = "ramp 400 Nm/s, active damping", "ramp, active damping, soft landing"
    found = medians("tip-in", ramp, soft)
    assert found[ramp]["load_jerk"] < 45e3 and found[soft]["load_jerk"] < 45e3
    assert found[soft]["arrival_time"] < 0.4 * found[ramp]["arrival_time"]
    assert found[soft]["lash_time"] < 0.010 and found[soft]["impact_speed"] < 0.6
    assert medians("tip-out", soft)["load_jerk"] < 45e3
    assert medians("tip-in", "ramp 500 Nm/s, active damping")["load_jerk"] > 45e3


def test_the_papers_laws_and_soft_landing():
    pi, poles, soft = "PI, Table II", "pole placement", "soft landing"
    found = medians("step", pi, poles, soft)
    assert found[pi]["overshoot"] > 5.0 and found[poles]["overshoot"] < 2.0
    assert found[poles]["peak_torque"] > 1.5 * found[pi]["peak_torque"]
    assert found[poles]["oscillation"] > 2.0 * found[pi]["oscillation"]
    assert found[soft]["impact_speed"] < 0.25 * found[poles]["impact_speed"]
    assert found[soft]["arrival_time"] < 1.15 * found[poles]["arrival_time"]
    assert found[soft]["oscillation"] < 0.5 * found[poles]["oscillation"]


def test_soft_landing_with_the_motor_bounded_keeps_every_share_of_pole_placement():
    poles, soft = "pole placement", "soft landing, bounded"
    # Two rigs are too few for a share of 5 %: each has its own phase of the joint at the landing.
    step, load = medians("step", poles, soft, rigs=(1, 2, 3, 4)), medians("load step", soft)
    shares = {
        "arrival_time": 1.1, "rise_time": 1.0, "impact_speed": 0.25, "oscillation": 0.5, "motor_overshoot": 0.6,
        "motor_deviation": 0.6,
    }  # fmt: skip
    for name, share in shares.items():
        assert step[soft][name] <= share * step[poles][name], name
    assert step[soft]["overshoot"] <= 1.0 and step[soft]["impact_speed"] <= 1.0
    assert step[soft]["peak_torque"] <= 73.5 and step[soft]["steady_error"] <= 1e-3
    assert load["recovery_time"] <= 0.06 and load["steady_error"] <= 1e-3


def test_a_backlash_that_is_wrong_by_a_fifth_costs_no_more_impact_than_pole_placement():
    for case in ("known backlash −20 %", "known backlash +20 %"):
        found = medians(case, "pole placement", "soft landing, bounded")
        assert found["soft landing, bounded"]["impact_speed"] < found["pole placement"]["impact_speed"]


@pytest.mark.parametrize("name", ["adaptive soft landing", "adaptive flat, 200 rad/s²"])
@pytest.mark.parametrize("case", [c.name for c in CASES if c.load_inertia != 1.0])
def test_a_law_that_tracks_the_load_inertia_stands_its_change(case, name):
    found = medians(case, name)
    assert found["overshoot"] < 8.0 and found["unstable"] == 0.0


@pytest.mark.parametrize("case", [c.name for c in CASES if c.work == "rest" and c.drive == "rig"])
def test_the_load_rests_exactly(case):
    found = medians(case, "soft landing, bounded")
    assert found["rest_speed"] == 0.0 and found["ripple"] < 1.5 and found["overshoot"] == 0.0

"""What the laws promise on the virtual rig, on few rigs; the leaderboard has the numbers of twenty."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.compare.controllers import CASES, CONTESTANTS
from lostmotion.compare.controllers.experiment import experiment, run
from lostmotion.compare.controllers.scores import score

CASE = {case.name: case for case in CASES}
ENTRY = {entry.name: entry for entry in CONTESTANTS}
RIGS = (1, 2)


def medians(case, *names):
    """Median over rigs of every metric, by law."""
    found = {}
    for name in names:
        data = [experiment(CASE[case], seed) for seed in RIGS]
        scores = [score(run(ENTRY[name], d), d) for d in data]
        found[name] = {
            m: float(np.median([s[m] for s in scores])) for m in scores[0] if scores[0][m] is not None
        }
    return found if len(names) > 1 else found[names[0]]


def test_a_tip_in_with_soft_landing_is_faster_than_any_ramp_of_equal_jerk():
    ramp, soft = "ramp 400 Nm/s, active damping", "ramp, active damping, soft landing"
    found = medians("tip-in", ramp, soft)
    assert found[ramp]["load_jerk"] < 45e3 and found[soft]["load_jerk"] < 45e3
    assert found[soft]["arrival_time"] < 0.4 * found[ramp]["arrival_time"]
    assert found[soft]["lash_time"] < 0.011 and found[soft]["impact_speed"] < 0.6
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


@pytest.mark.parametrize("case", [c.name for c in CASES if c.work == "rest"])
def test_the_load_rests_exactly(case):
    found = medians(case, "soft landing")
    assert found["rest_speed"] == 0.0 and found["ripple"] < 1.5 and found["overshoot"] == 0.0

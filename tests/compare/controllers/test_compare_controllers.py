"""The leaderboard of the controllers: the loop, the scores, the tables, and that it goes on."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

from lostmotion.compare import compare_controllers
from lostmotion.compare.controllers import CASES, CONTESTANTS, ControlTable
from lostmotion.compare.controllers.cases import WORKS
from lostmotion.compare.controllers.compare_controllers import CONTROLLERS
from lostmotion.compare.controllers.experiment import APART, designed, experiment, run
from lostmotion.compare.controllers.score_controllers import score_controllers
from lostmotion.compare.controllers.scores import score
from lostmotion.compare.controllers.work import work
from lostmotion.compare.zoo_drive import zoo_drive
from lostmotion.errors import InvalidInput
from lostmotion.plot.controllers.leaderboard import controller_leaderboard
from lostmotion.rig import SETS, TORQUE_LIMIT

CASE = {case.name: case for case in CASES}
ENTRY = {entry.name: entry for entry in CONTESTANTS}


@pytest.fixture(scope="module")
def step():
    return experiment(CASE["step"], 1)


@pytest.fixture(scope="module")
def pulled(step):
    return run(designed(ENTRY["pole placement"], step), step)


def test_names_are_unique_and_every_work_has_a_case():
    assert len(CASE) == len(CASES) and len(ENTRY) == len(CONTESTANTS)
    assert {case.work for case in CASES} == set(WORKS)


@pytest.mark.parametrize("kind", WORKS)
def test_a_work_asks_for_one_thing_and_is_judged_within_its_length(kind):
    asked = work(kind, 1e-4, 0.13)
    (reference,) = asked.references.values()
    assert 0.0 < asked.start < asked.stop <= 1e-4 * reference.size + 1e-9
    assert asked.asks_for_torque == kind.startswith("tip")
    before, after = (reference[round(t / 1e-4)] for t in (asked.start - 1e-3, asked.start + 1e-3))
    if kind in ("step", "pulse", "rest", "tip-in", "tip-out"):
        assert (before, after) == (asked.before, asked.after)


def test_the_laws_know_the_identified_model_and_not_the_changed_rig(step):
    heavy = experiment(CASE["load inertia × 3"], 1)
    assert heavy.setting.model == step.setting.model
    assert heavy.plant.drivetrain.inertias[-1] == 3.0 * step.plant.drivetrain.inertias[-1]
    wrong = experiment(CASE["known backlash +20 %"], 1)
    assert wrong.setting.model.backlash == pytest.approx(1.2 * step.setting.model.backlash)
    assert wrong.plant.drivetrain == step.plant.drivetrain
    assert step.setting.model.backlash != step.plant.drivetrain.shafts[-1].backlash


def test_a_drive_of_the_zoo_has_its_own_sample_time_delay_and_model():
    first, second = (experiment(CASE["zoo, step"], seed) for seed in (1, 2))
    assert first.plant.drivetrain != second.plant.drivetrain
    for data, seed in ((first, 1), (second, 2)):
        bench = zoo_drive(seed, APART)
        assert data.setting.model == bench.model and data.setting.dt == bench.dt and data.delay == bench.delay
        assert data.setting.dt / data.dt == pytest.approx(round(data.setting.dt / data.dt))
        assert data.plant.drivetrain.actuator.torque_limit == pytest.approx(TORQUE_LIMIT)
        assert bench.seed in SETS["test"]
    wrong = experiment(CASE["zoo, known backlash +20 %"], 1)
    assert wrong.setting.model.backlash == pytest.approx(1.2 * first.setting.model.backlash)
    assert wrong.plant.drivetrain == first.plant.drivetrain


def test_the_delay_of_a_drive_of_the_zoo_acts():
    data, law = experiment(CASE["zoo, step"], 3), ENTRY["PI, Table II"]

    def jump(delay):
        """Row at which the proportional part of the step acts."""
        late = replace(data, delay=delay)
        torque = run(designed(law, late), late)["torque_motor"]
        start = round(data.work.start / data.dt)
        return int(np.flatnonzero(np.abs(np.diff(torque[start:])) > 20.0)[0])

    assert jump(data.delay + 2) - jump(data.delay) == 2 * round(data.setting.dt / data.dt)


@pytest.mark.parametrize(
    "case", ["zoo, step", "step", "true states", "sample time 1 ms", "backlash × 0", "drop-outs 2 %"]
)
@pytest.mark.parametrize("name", ENTRY)
def test_every_law_runs_and_never_asks_for_more_than_the_limit(name, case):
    data = experiment(CASE["tip-in" if ENTRY[name].kind == "torque" else case], 1)
    # The rig itself has no limit here, so it shows what the law asks for.
    free = replace(data.plant.drivetrain.actuator, torque_limit=np.inf)
    plant = replace(data.plant, drivetrain=replace(data.plant.drivetrain, actuator=free))
    changed = replace(data, plant=plant)
    found = run(designed(ENTRY[name], changed), changed)
    assert np.all(np.isfinite(found["torque_motor"]))
    assert np.max(np.abs(found["torque_motor"])) <= TORQUE_LIMIT


def test_scores_of_a_step(step, pulled):
    found = score(pulled, step)
    assert 0.015 < found["arrival_time"] < 0.02 and found["overshoot"] < 2.0
    assert 2.5 < found["impact_speed"] < 4.5 and found["impacts"] == 1.0
    assert found["unstable"] == 0.0 and found["ripple"] is None and found["recovery_time"] is None


def test_a_law_that_stops_is_unstable_and_a_number_that_is_none_counts_so(step, pulled):
    still = pulled.with_signals("simulated", speed_load=np.zeros(len(pulled)))
    assert score(still, step)["unstable"] == 1.0
    broken = pulled.with_signals("simulated", speed_load=np.full(len(pulled), np.nan))
    assert score(broken, step)["unstable"] == 1.0


def test_jerk_of_a_parabola(step, pulled):
    jerk, time = 5e4, pulled.time - step.work.start
    speed = pulled.with_signals("simulated", speed_load=0.5 * jerk * time**2)
    assert score(speed, step)["load_jerk"] == pytest.approx(jerk, rel=1e-6)


def test_a_load_torque_is_in_the_scores():
    data = experiment(CASE["load step"], 1)
    found = score(run(designed(ENTRY["LQI"], data), data), data)
    assert 0.4 < found["recovery_error"] < 1.0 and found["recovery_time"] < 0.06
    assert found["overshoot"] is None


CHOSEN = {"cases": ["step", "encoder 14 bit"], "controllers": ["PI, Table II"], "seeds": [1], "workers": 1}


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("controllers")
    return folder, compare_controllers(folder, **CHOSEN)


def test_tables(small):
    folder, table = small
    assert list(table.entries) == ["PI, Table II", "pole placement"]
    data = json.loads((folder / "leaderboard.json").read_text())
    assert data == json.loads(json.dumps(table.to_dict()))
    middle, low, high, worst = data["cases"][0]["controllers"]["pole placement"]["arrival_time"]
    assert middle == low == high == worst
    rows = list(csv.DictReader((folder / "leaderboard.csv").open()))
    assert [row["controller"] for row in rows] == 2 * ["PI, Table II", "pole placement"]
    text = (folder / "leaderboard.md").read_text()
    assert text.count("| pole placement |") == 6 and "encoder 10 to 18 bit" in text
    assert (folder / "leaderboard.svg").stat().st_size > 5000


def test_a_law_that_cannot_be_designed_is_refused_and_the_rest_goes_on(monkeypatch):
    def impossible(setting):
        raise InvalidInput("controller", "this drive", "another", "None.")

    entries = [replace(ENTRY["PI, Table II"], control=impossible), ENTRY["pole placement"]]
    monkeypatch.setattr("lostmotion.compare.controllers.score_controllers.CONTESTANTS", entries)
    _, _, found = score_controllers(("true states", 1, None, ("PI, Table II", "pole placement")))
    assert found["PI, Table II"]["refused"] == 1.0 and found["PI, Table II"]["overshoot"] is None
    assert found["pole placement"]["refused"] == 0.0 and found["pole placement"]["overshoot"] < 2.0


def test_a_fault_of_the_run_is_no_refusal(monkeypatch):
    """A refusal is the design's: what the simulation does not take is an error of ours, and must be seen."""

    def broken(laws, data):
        raise InvalidInput("simulate", "a fault", "none", "None.")

    monkeypatch.setattr("lostmotion.compare.controllers.score_controllers.run", broken)
    with pytest.raises(InvalidInput, match="a fault"):
        score_controllers(("true states", 1, None, ("PI, Table II",)))


def test_what_is_told_of_unstable_runs_is_their_share():
    scores = {
        "step": {seed: {"LQI": {"unstable": float(seed == 1), "overshoot": 2.0}} for seed in (1, 2, 3, 4)}
    }
    table = ControlTable({"LQI": "speed"}, (CASE["step"],), (1, 2, 3, 4), scores, {})
    found = table.median("LQI", "step", "unstable")
    assert found.value == 0.25 and found.low == 0.0 and found.high > 0.25
    assert table.median("LQI", "step", "overshoot").value == 2.0
    assert "| 2 |" in table.to_markdown() and "| 25 |" in table.to_markdown()


def test_quick_is_two_rigs_and_the_main_cases_and_all_is_twenty_fresh_rigs(monkeypatch):
    """The seeds of the table are none that a law was tuned on (1 to 40)."""
    told = replace(CONTROLLERS, work=lambda job: (job[0], job[1], {name: {} for name in job[3]}))
    monkeypatch.setitem(compare_controllers.__globals__, "CONTROLLERS", told)
    quick, whole = compare_controllers(quick=True, workers=1), compare_controllers(workers=1)
    assert quick.seeds == (401, 402) and whole.seeds == tuple(range(401, 421))
    assert list(quick.entries) == list(whole.entries) == [entry.name for entry in CONTESTANTS]
    assert whole.cases == CASES and quick.cases == tuple(case for case in CASES if case.quick)
    assert {"step", "load step", "rest", "tip-in"} <= {case.work for case in quick.cases} and len(
        quick.cases
    ) < 12


def test_it_goes_on_where_it_was_stopped(small):
    folder, _ = small
    scores = sorted((folder / "scores").glob("*.json"))
    assert len(scores) == 2
    scores[0].unlink()
    told = []
    compare_controllers(folder, **CHOSEN, progress=lambda fraction, text: told.append(text))
    assert len(told) == 1


def test_misuse(small):
    with pytest.raises(InvalidInput, match=r"compare_controllers\.controllers.*compare controllers --list"):
        compare_controllers(controllers=["nobody"])
    with pytest.raises(InvalidInput, match="no step of the speed"):
        controller_leaderboard({**small[1].to_dict(), "cases": []})

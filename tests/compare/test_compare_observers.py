"""The leaderboard: experiments, scores, statistics, tables, and that it goes on where it was stopped."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest

from lostmotion import rig
from lostmotion.compare import CASES, CONTESTANTS, compare_observers, score_observers
from lostmotion.compare.compare_observers import OBSERVERS
from lostmotion.compare.contestants import Contestant
from lostmotion.compare.experiment import APART, experiment
from lostmotion.compare.scores import FAILED, METRICS, score
from lostmotion.compare.statistics import median, overall, ratio, verdict
from lostmotion.compare.zoo_drive import KINDS, zoo_drive
from lostmotion.errors import InvalidInput
from lostmotion.recording import Recording

CASE = {case.name: case for case in CASES}
CHOSEN = ("motor speed", "without backlash", "Observer 1")


@pytest.fixture(scope="module")
def nominal():
    return experiment(CASE["nominal"], 1, 1.0)


# Experiments.


def test_names_are_unique_and_the_reference_takes_part():
    assert len({c.name for c in CASES}) == len(CASES)
    names = [entry.name for entry in CONTESTANTS]
    assert len(set(names)) == len(names)
    assert names.count("Observer 1") == 1
    assert [e.kind for e in CONTESTANTS].count("naive") == 3


def test_observers_see_nothing_of_the_truth(nominal):
    assert set(nominal.recording.names) == {"torque_motor", "speed_motor", "torque_shaft"}
    assert 0.2 < nominal.truth["gap"].mean() < 0.7
    # The joint is open where the truth says so: the side shaft then carries the joint piece alone.
    torque = np.abs(nominal.truth["torque_shaft"])
    assert np.median(torque[nominal.truth["gap"] > 0.5]) < 0.1 * np.median(torque[nominal.truth["gap"] < 0.5])


def test_the_same_seed_gives_the_same_bytes(nominal):
    again = experiment(CASE["nominal"], 1, 1.0)
    for name in nominal.recording:
        np.testing.assert_array_equal(again.recording[name], nominal.recording[name])
    assert not np.array_equal(
        experiment(CASE["nominal"], 2, 1.0).truth["speed_load"], nominal.truth["speed_load"]
    )


@pytest.mark.parametrize("name, late", [("delay 0.4 samples", 0.4), ("delay 1 sample", 1.0)])
def test_a_late_sensor_shows_the_past(nominal, name, late):
    data = experiment(CASE[name], 1, 1.0)
    np.testing.assert_array_equal(data.truth["speed_load"], nominal.truth["speed_load"])
    shown = np.cumsum(data.recording["speed_motor"]) * 1e-4
    prompt = np.cumsum(nominal.recording["speed_motor"]) * 1e-4
    row = np.arange(shown.size)
    wanted = np.interp(row - late, row, prompt)
    # Two counts of 6 µrad each, and the curvature between two samples.
    np.testing.assert_allclose(shown[10:], wanted[10:], atol=1.5e-5)
    assert np.max(np.abs(prompt - wanted)) > 1e-4


def test_what_nobody_tells_the_observers(nominal):
    lost = np.isnan(experiment(CASE["drop-outs 2 %"], 1, 4.0).recording["speed_motor"])
    assert 0.005 < lost.mean() < 0.04
    loaded = experiment(CASE["load torque 3 Nm"], 1, 1.0)
    np.testing.assert_array_equal(loaded.recording["torque_motor"], nominal.recording["torque_motor"])
    assert np.ptp(loaded.truth["speed_load"] - nominal.truth["speed_load"]) > 1.0
    told = experiment(CASE["stiffness +20 %"], 1, 1.0).drivetrain
    assert told.stiffness == pytest.approx(1.2 * nominal.drivetrain.stiffness)
    assert told.backlash == nominal.drivetrain.backlash == nominal.backlash


def test_a_wrong_start_shows_the_other_side_first():
    data = experiment(CASE["wrong start"], 1, 1.0)
    first = data.judged.start
    assert np.all(data.recording["torque_motor"][:first] < 0.0)
    # The shaft still rings at 100 Hz, damped by 2 %: so ten periods of it.
    assert np.mean(data.truth["torque_shaft"][first - 1000 : first]) == pytest.approx(1.2, rel=0.02)
    assert np.mean(data.recording["torque_shaft"][first - 1000 : first]) == pytest.approx(-1.2, abs=0.1)
    assert np.max(np.abs(data.truth["speed_load"][first - 1000 : first])) == 0.0


def test_sticking_sticks():
    data = experiment(CASE["sticking"], 1, 1.0)
    assert np.mean(data.truth["speed_load"] == 0.0) > 0.4


#: Seeds whose drives of the zoo are not those of the leaderboard.
OTHERS = (30, 31)


@pytest.mark.parametrize("kind", KINDS)
def test_on_any_drive_the_observers_are_given_its_equivalent_two_masses(kind):
    data, drive = experiment(CASE[f"any drive, {kind}"], 30, 1.0), zoo_drive(30, APART, KINDS[kind])
    assert data.drivetrain == drive.model and data.backlash == drive.model.backlash
    assert data.recording.dt == pytest.approx(drive.dt) and data.sensing.dt == drive.dt
    assert set(data.recording.names) == {"torque_motor", "speed_motor", "torque_shaft"}
    assert np.max(np.abs(data.recording["torque_motor"])) <= rig.TORQUE_LIMIT
    assert len(data.truth["gap"]) == len(data.recording) and np.ptp(data.truth["speed_load"]) > 5.0


def test_observers_that_know_the_joint_follow_any_drive():
    for seed in OTHERS:
        data = experiment(CASE["any drive, two masses"], seed, 1.5)
        entries = {entry.name: entry for entry in CONTESTANTS}
        errors = {
            n: score(entries[n].make(data.drivetrain, data.sensing), data)["speed_load"] for n in CHOSEN
        }
        assert errors["Observer 1"] < 0.01 and errors["Observer 1"] < 0.3 * errors["without backlash"]


def test_the_delay_of_a_drive_is_part_of_the_models_lag(monkeypatch):
    drive = next(b for b in map(rig.bench, range(100)) if b is not None and b.delay > 4)
    found = []
    for delay in (1, drive.delay):
        monkeypatch.setattr(
            "lostmotion.compare.experiment.zoo_drive", lambda *_, d=delay: replace(drive, delay=d)
        )
        found.append(experiment(CASE["any drive, two masses"], 1, 1.0))
    np.testing.assert_array_equal(*(data.recording["torque_motor"] for data in found))
    late = drive.delay - 1
    prompt, delayed = (data.truth["speed_load"] for data in found)
    np.testing.assert_allclose(delayed[late:], prompt[:-late], atol=1e-9)
    assert drive.model.lag == pytest.approx(drive.rig.drivetrain.lag + late * drive.dt)


@pytest.mark.parametrize("law", ["dead_zone", "viscoelastic"])
def test_the_joint_is_open_where_it_transmits_nothing_but_damping(monkeypatch, law):
    drive = rig.bench(3)
    (shaft,) = drive.rig.drivetrain.shafts
    chain = replace(drive.rig.drivetrain, shafts=(replace(shaft, contact=law),))
    changed = replace(drive, rig=replace(drive.rig, drivetrain=chain))
    monkeypatch.setattr("lostmotion.compare.experiment.zoo_drive", lambda *_: changed)
    truth = experiment(CASE["any drive, two masses"], 1, 1.0).truth
    is_open = truth["gap"] > 0.5
    assert 0.05 < is_open.mean() < 0.5
    signal = "twist_elastic" if law == "dead_zone" else "torque_shaft"
    np.testing.assert_array_equal(is_open, truth[signal] == 0.0)


# Scores.


class Told:
    """An observer that knows the truth, ``late`` samples ago."""

    inputs = ("torque_motor",)

    def __init__(self, data, late=0):
        self.signals = {f"{n}_estimated": np.roll(v, late) for n, v in data.truth.items() if n != "gap"}
        # The side shaft rings in the open joint; what the joint transmits is zero there.
        self.signals["torque_shaft_estimated"] = np.roll(
            np.where(data.truth["gap"] > 0.5, 0.0, data.truth["torque_shaft"] + 1e-9), late
        )
        self.signals["backlash_estimated"] = np.full(len(data.recording), 1.1 * data.backlash)

    def run(self, data):
        return Recording(time=data.time, signals=self.signals)


def test_who_knows_the_truth_makes_no_error(nominal):
    found = score(Told(nominal), nominal)
    assert set(found) == {*METRICS, "torque_sensor"}
    assert found["speed_load"] == found["twist_elastic"] == 0.0
    assert found["f1_gap"] > 0.98
    assert found["impact_delay"] == 0.0 and found["impacts_found"] == 1.0
    assert found["backlash_error"] == pytest.approx(0.1)


def test_who_is_late_finds_the_impacts_late(nominal):
    found = score(Told(nominal, late=4), nominal)
    assert found["impact_delay"] == pytest.approx(4e-4)
    assert found["f1_gap"] < score(Told(nominal), nominal)["f1_gap"] - 0.03


@pytest.mark.parametrize("nothing", [np.nan, np.inf, -np.inf, 1e300])
def test_an_observer_that_fails_has_a_large_error(nominal, nothing):
    broken = Told(nominal)
    for signal in broken.signals:
        broken.signals[signal] = np.full(len(nominal.recording), nothing)
    found = score(broken, nominal)
    for metric in ("speed_load", "torque_shaft", "twist_elastic", "backlash_error"):
        assert 1e3 < found[metric] < np.inf
    assert found["f1_gap"] == 0.0 and found["impact_delay"] is None


def test_an_observer_that_cannot_be_made_has_failed(monkeypatch):
    def refuse(drivetrain, sensing):
        raise InvalidInput("observer", "this drive", "another", "Take another.")

    monkeypatch.setattr(
        score_observers, "CONTESTANTS", (Contestant("refuses", "naive", refuse), CONTESTANTS[0])
    )
    case, seed, found = score_observers.score_observers(("nominal", 3, 1.0, ("refuses", "motor speed")))
    assert (case, seed) == ("nominal", 3) and set(found) == {"refuses", "motor speed"}
    assert found["refuses"]["speed_load"] >= FAILED > found["motor speed"]["speed_load"]
    assert found["refuses"]["time_per_sample"] is None


def test_nan_is_worse_than_zero(nominal):
    broken, idle = Told(nominal), Told(nominal)
    broken.signals["speed_load_estimated"] = idle.signals["speed_load_estimated"] * 0.0
    broken.signals["speed_load_estimated"][-1] = np.nan
    idle.signals["speed_load_estimated"] = np.zeros(len(nominal.recording))
    assert score(broken, nominal)["speed_load"] > 1e3 * score(idle, nominal)["speed_load"]


def test_who_reads_the_torque_sensor(nominal):
    found = Told(nominal)
    assert score(found, nominal)["torque_sensor"] == 0.0
    found.inputs = ("torque_motor", "torque_shaft")
    assert score(found, nominal)["torque_sensor"] == 1.0


# Statistics.


def test_bootstrap():
    values = np.random.default_rng(0).normal(3.0, 1.0, 100)
    found = median(values)
    assert found.low < found.value < found.high
    assert found.high - found.low == pytest.approx(2 * 1.96 * 1.2533 / 10.0, rel=0.5)
    own, reference = {1: 2.0, 2: 2.0, 3: 8.0, 9: 1.0}, {1: 1.0, 2: 1.0, 3: 4.0, 4: 1.0}
    assert ratio(own, reference) == (same := ratio(own, {1: 1.0, 2: 1.0, 3: 4.0}))
    assert same is not None and same.value == pytest.approx(2.0) == same.high
    assert ratio({1: 1.0}, {2: 1.0}) is None
    a, b = {1: np.log(4.0), 2: np.log(4.0)}, {1: 0.0, 2: 0.0, 3: 5.0}
    for table in ({"one": {"a": a}, "other": {"b": b}}, {"one": {"a": a, "b": b}}):
        both = overall(table)
        assert both is not None and both.value == pytest.approx(2.0)
    grouped = overall({"one": {"a": a}, "other": {"b": b, "c": b, "d": b}})
    assert grouped is not None and grouped.value == pytest.approx(2.0)
    assert overall({}) is None and overall({"one": {"a": {1: 0.0}, "b": {2: 0.0}}}) is None


def test_verdict_needs_an_interval_on_one_side_and_seeds():
    better, unclear = median([0.5] * 6), median([0.5, 0.5, 0.5, 2.0, 2.0, 2.0])
    worse = replace(better, value=2.0, low=1.5, high=3.0)
    assert [verdict(v, 6) for v in (better, unclear, worse, None)] == ["win", "tie", "loss", "–"]
    assert verdict(better, 4) == "–"


# The whole comparison.


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    folder = tmp_path_factory.mktemp("leaderboard")
    calls = []
    board = compare_observers(
        folder, seeds=2, cases=("nominal", "stiffness +20 %"), observers=CHOSEN, duration=1.0, workers=1,
        progress=lambda fraction, text: calls.append((fraction, text)),
    )  # fmt: skip
    return folder, board, calls


def test_tables(small):
    folder, board, calls = small
    assert [fraction for fraction, _ in calls] == [0.25, 0.5, 0.75, 1.0]
    assert board.ranking() == ["Observer 1", "without backlash", "motor speed"]
    data = json.loads((folder / "leaderboard.json").read_text())
    assert data == json.loads(json.dumps(board.to_dict()))
    assert data["observers"][0]["overall_ratio"] == [1.0, 1.0, 1.0]
    cell = data["cases"][0]["observers"]["motor speed"]
    assert 0.1 < cell["speed_load"][0] < 0.25 and cell["torque_shaft"] is None
    rows = list(csv.DictReader((folder / "leaderboard.csv").open()))
    assert len(rows) == 2 * 2 * 3
    assert {row["observer"] for row in rows} == set(CHOSEN)
    text = (folder / "leaderboard.md").read_text()
    assert text.index("| Observer 1 |") < text.index("| motor speed |")
    assert (folder / "leaderboard.svg").stat().st_size > 5000


def test_it_goes_on_where_it_was_stopped(small):
    folder, board, _ = small
    scores = sorted((folder / "scores").glob("*/*.json"))
    assert len(scores) == 4
    scores[0].unlink()
    scores[1].write_text(scores[1].read_text()[:100])
    calls = []
    again = compare_observers(
        folder, seeds=2, cases=("nominal", "stiffness +20 %"), observers=CHOSEN, duration=1.0, workers=2,
        progress=lambda fraction, text: calls.append(text),
    )  # fmt: skip
    assert len(calls) == 2
    for case in board.scores:
        for seed in board.seeds:
            for name in CHOSEN:
                a, b = (dict(x.scores[case][seed][name], time_per_sample=0.0) for x in (board, again))
                assert a == b


def test_another_duration_leaves_the_scores_of_the_first(small):
    folder, _, _ = small
    scores = {path: path.read_bytes() for path in (folder / "scores").glob("*/*.json")}
    calls = []
    compare_observers(
        folder, seeds=[1], cases=["nominal"], observers=["motor speed"], duration=1.2, workers=1,
        progress=lambda fraction, text: calls.append(text),
    )  # fmt: skip
    assert len(calls) == 1
    assert {path: path.read_bytes() for path in scores} == scores


def test_the_table_is_of_rigs_that_nothing_was_tuned_on(monkeypatch):
    told = replace(OBSERVERS, work=lambda job: (job[0], job[1], {name: {} for name in job[3]}))
    monkeypatch.setitem(compare_observers.__globals__, "OBSERVERS", told)
    chosen = {"cases": ["nominal"], "observers": ["Observer 1"], "workers": 1}
    assert compare_observers(**chosen).seeds == tuple(range(501, 521))
    assert compare_observers(quick=True, **chosen).seeds == (501, 502)
    assert compare_observers(seeds=(3, 7), **chosen).seeds == (3, 7)


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"cases": ["nominal", "wild"]}, "wild"),
        ({"observers": ["nobody"]}, "nobody"),
        ({"seeds": 0}, "seeds"),
        ({"cases": "nominal"}, "cases"),
        ({"observers": []}, "observers"),
        ({"seeds": [1, 1]}, "seeds"),
        ({"seeds": 1.5}, "seeds"),
        ({"seeds": "3"}, "seeds"),
        ({"seeds": [1.5]}, "seeds"),
        ({"seeds": True}, "seeds"),
        ({"workers": -1}, "workers"),
        ({"workers": 1.5}, "workers"),
        ({"duration": "long"}, "duration"),
        ({"duration": 0.5}, "duration"),
        ({"duration": float("nan")}, "duration"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        compare_observers(**arguments)


def test_figure(small):
    from lostmotion.plot import leaderboard

    _, board, _ = small
    figure = leaderboard(board.to_dict())
    axis = figure.axes[0]
    shown = [text.get_text() for text in axis.texts]
    worst = board.worst_of_group("motor speed", "nominal", "speed_load")
    assert shown[-2] == f"{100.0 * worst:.0f}"
    assert axis.get_yticklabels()[0].get_text().startswith("Observer 1")
    with pytest.raises(InvalidInput, match="no backlash_error"):
        leaderboard(board.to_dict(), metric="backlash_error")


def test_figure_shows_the_worst_case_of_a_group():
    from lostmotion.plot import leaderboard

    def case(name, value):
        return {"name": name, "group": "both", "observers": {"one": {"speed_load": [value, value, value]}}}

    board = {
        "observers": [{"name": "one", "overall_ratio": None}], "seeds": [1], "reference": "one",
        "cases": [case("a", 0.002), case("b", 0.03), case("c", 0.01)],
    }  # fmt: skip
    assert [text.get_text() for text in leaderboard(board).axes[0].texts] == ["3"]

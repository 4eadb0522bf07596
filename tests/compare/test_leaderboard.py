"""Ranking and tables, from scores that are made up."""

from __future__ import annotations

import csv
import io
import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compare import CASES, Leaderboard
from lostmotion.compare.scores import METRICS

NOISY = tuple(case.name for case in CASES if case.name.startswith("torque sensor"))
SIXTEEN = "one parameter off by 20 %"


def error(name, case):
    """Load-speed error relative to Observer 1."""
    if name == "steady":  # half the error, but in the sixteen cases of one group twice the error
        return 2.0 if case.group == SIXTEEN else 0.5
    if name == "with sensor":
        return 3.0 if case.name in NOISY else 0.5
    return 1.0


def time(name, case):
    return 3e-6 if name == "steady" and case.dt == 1e-3 else 1e-7 / (1.0 + 1e4 * case.dt)


def board(cases=CASES, rigs=6, names=("Observer 1", "steady", "with sensor")):
    seeds = tuple(range(1, rigs + 1))

    def score(name, case, seed):
        return {
            **dict.fromkeys(METRICS),
            "speed_load": 0.01 * seed * error(name, case),
            "time_per_sample": time(name, case),
            "torque_sensor": float(name == "with sensor"),
        }

    return Leaderboard(
        entries=dict.fromkeys(names, "fixed gain"),
        cases=cases,
        seeds=seeds,
        scores={c.name: {s: {n: score(n, c, s) for n in names} for s in seeds} for c in cases},
        settings={"duration": 3.0, "quick": False},
    )


@pytest.fixture(scope="module")
def full():
    return board()


def row(markdown, name):
    line = next(line for line in markdown.splitlines() if line.startswith(f"| {name} |"))
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_a_group_weighs_as_much_as_a_single_case(full):
    groups = len({case.group for case in CASES})
    expected = np.exp((np.log(2.0) + (groups - 1) * np.log(0.5)) / groups)
    assert full.overall("steady").value == pytest.approx(expected)
    assert full.overall("Observer 1").value == 1.0
    assert full.ranking()[-1] == "Observer 1"


def test_noise_of_the_torque_sensor_counts_for_those_who_read_it(full):
    assert len(NOISY) == 3
    assert full.wins("steady") == {"win": len(CASES) - 3 - 16, "tie": 0, "loss": 16}
    assert full.wins("with sensor") == {"win": len(CASES) - 3, "tie": 0, "loss": 3}
    assert {c.name for c in CASES} - {c.name for c in full.counted("steady")} == set(NOISY)
    assert "motor torque ripple 1 Nm" in {c.name for c in full.counted("steady")}
    assert full.counted("with sensor") == CASES


def test_noise_beside_something_else_is_a_case_for_all():
    from dataclasses import replace

    both = replace(CASES[0], name="both", torque_noise=1.0, encoder_bits=12)
    assert board(cases=(CASES[0], both)).counted("steady") == (CASES[0], both)


def test_no_case_counts():
    noisy = tuple(case for case in CASES if case.name in NOISY)
    found = board(cases=noisy)
    assert found.overall("steady") is None and found.wins("steady") is None
    assert row(found.to_markdown(), "steady")[3:5] == ["–", "–"]


def test_rows_that_need_a_torque_sensor_are_marked(full):
    data = full.to_dict()
    marks = {entry["name"]: entry["needs_torque_sensor"] for entry in data["observers"]}
    assert marks == {"Observer 1": False, "steady": False, "with sensor": True}
    text = full.to_markdown()
    assert [row(text, name)[2] for name in marks] == ["yes" if need else "no" for need in marks.values()]
    assert f"Only for observers that read the torque sensor: {', '.join(NOISY)}." in text
    assert "torque sensor:" not in board(cases=CASES[:2]).to_markdown()


def test_the_figure_marks_them_too(full):
    from lostmotion.plot import leaderboard

    axis = leaderboard(full.to_dict()).axes[0]
    labels = [label.get_text() for label in axis.get_yticklabels()]
    assert [("†" in label) for label in labels] == [label.startswith("with sensor") for label in labels]
    assert "† needs a torque sensor" in axis.get_title(loc="left")
    plain = leaderboard(board(names=("Observer 1", "steady")).to_dict()).axes[0]
    assert "†" not in plain.get_title(loc="left")


def test_who_fails_on_a_drive_counts_as_failed_however_badly():
    names, seeds = ("Observer 1", "fails"), (1, 2, 3, 4, 5, 6)
    case = next(case for case in CASES if case.drive == "3 to 5 masses")

    def made(worst):
        errors = {"Observer 1": [0.01] * 6, "fails": [0.005] * 4 + worst}
        return Leaderboard(
            entries=dict.fromkeys(names, "fixed gain"), cases=(case,), seeds=seeds, settings={},
            scores={case.name: {s: {n: {"speed_load": errors[n][s - 1]} for n in names} for s in seeds}},
        )  # fmt: skip

    one, two = made([0.3, 1e9]), made([7.0, 1e9])
    assert one.overall("fails").value == pytest.approx((0.5**4 * 30.0 * 100.0) ** (1 / 6))
    assert two.overall("fails").value == pytest.approx((0.5**4 * 100.0 * 100.0) ** (1 / 6))
    assert zoo_rows(one.to_markdown()) == {"Observer 1": "1 (1)", "fails": "0.5 (1 failed)"}
    assert zoo_rows(two.to_markdown())["fails"] == "0.5 (2 failed)"
    assert zoo_rows(made([0.3, 0.02]).to_markdown())["fails"] == "0.5 (30)"
    assert "on how" not in board(cases=CASES[:2]).to_markdown()


def zoo_rows(markdown):
    """Cells of the table that has drives of the zoo alone."""
    rows = markdown.partition("Load speed on drives of the zoo")[2].splitlines()
    found = [
        [cell.strip() for cell in line.strip("|").split("|")]
        for line in rows
        if "(" in line and line[0] == "|"
    ]
    return {cells[0]: cells[1] for cells in found}


def test_few_rigs_prove_nothing():
    few = board(rigs=4)
    assert few.wins("steady") is None
    assert few.to_dict()["observers"][0]["wins"] is None
    text = few.to_markdown()
    assert row(text, "steady")[4] == "–" and "0 – 0 – 0" not in text
    assert "Fewer than 5 rigs: no wins" in text
    assert "Fewer than" not in board(rigs=5).to_markdown()


def test_time_at_the_slowest_sample_time(full):
    assert full.time_per_sample("steady") == pytest.approx(5e-8)
    assert full.largest_time_per_sample("steady") == 3e-6
    entry = next(e for e in full.to_dict()["observers"] if e["name"] == "steady")
    assert (entry["time_per_sample"], entry["largest_time_per_sample"]) == (pytest.approx(5e-8), 3e-6)
    assert row(full.to_markdown(), "steady")[5:] == ["0.05", "3.00"]


def test_json_says_what_was_compared_by_what(full):
    data = json.loads(json.dumps(full.to_dict(), allow_nan=False))
    assert data["version"] == lm.__version__
    assert data["seeds"] == [1, 2, 3, 4, 5, 6]
    assert data["settings"]["duration"] == 3.0
    assert data == json.loads(json.dumps(board().to_dict()))


def test_csv_has_a_line_for_each_score(full):
    rows = list(csv.DictReader(io.StringIO(full.to_csv())))
    assert len(rows) == len(CASES) * 6 * 3


def test_tables_fit_on_a_screen():
    text = board(names=("Observer 1", "extended Kalman, both sensors")).to_markdown()
    assert max(map(len, text.splitlines())) <= 120
    assert all(f"| {group} |" in text for group in {case.group for case in CASES if case.drive == "rig"})
    assert all(f"| {case.name} |" in text for case in CASES if case.drive != "rig")


def test_one_case_of_several_is_called_by_its_own_name(full):
    quick = board(cases=tuple(case for case in CASES if case.quick))
    table, figure = quick.to_markdown(), lm.plot.leaderboard(quick.to_dict())
    heads = [label.get_text() for label in figure.axes[0].get_xticklabels()]
    assert "| encoder 12 bit |" in table and "encoder 10 to 18 bit" not in table
    assert "encoder 12\nbit" in heads and "unknown load\ntorque" in heads
    whole = full.to_markdown()
    assert "| encoder 10 to 18 bit |" in whole and "| unknown load torque |" in whole

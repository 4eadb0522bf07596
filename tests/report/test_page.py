"""The page: complete, valid, self-contained, and safe with gaps and hostile text."""

from __future__ import annotations

import copy
import re
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from lostmotion.report import ReportFigure, render, write_report
from lostmotion.report.images import MAX_SVG_BYTES
from lostmotion.report.summary import cards

VOID = {"meta", "img", "br", "link", "hr", "input"}


def errors(rmse: float, span: float) -> dict[str, float]:
    return {"rmse": rmse, "range": span, "max": 4.0 * rmse, "lag": 2e-5, "rmse_of_range": rmse / span}


def observer(scale: float) -> dict[str, Any]:
    return {
        "speed_load": errors(0.008 * scale, 5.0),
        "torque_shaft": errors(0.6 * scale, 50.0),
        "twist": errors(1e-4 * scale, 0.02),
    }


def metrics(overshoot: float) -> dict[str, float | None]:
    return {
        "overshoot": overshoot,
        "rise_time": 0.0211,
        "settling_time": None,
        "peak_torque": 38.2,
        "steady_error": 3e-4,
    }


RESULTS: dict[str, Any] = {
    "seed": 7,
    "version": "0.1.0",
    "inputs": {"step.csv": "ab" * 32},
    "recordings": {
        "step": {"samples": 20000, "duration": 2.0, "sample_time": 1e-4, "signals": ["speed_motor"]}
    },
    "parameters": {
        "backlash": {
            "value": 0.01213,
            "low": 0.01205,
            "high": 0.01221,
            "unit": "rad",
            "source": "identified",
        },
        "stiffness": {
            "value": 6310.0,
            "low": 6240.0,
            "high": 6380.0,
            "unit": "Nm/rad",
            "source": "identified",
        },
        "inertia_motor": {"value": 0.018, "low": None, "high": None, "unit": "kg m2", "source": "nameplate"},
        "viscous_motor": {
            "value": None,
            "low": None,
            "high": None,
            "unit": "Nm s/rad",
            "source": "not excited",
        },
    },
    "truth": {"parameters": {"backlash": 0.012, "stiffness": 6285.9}},
    "fits": {"prediction": {"rms": {"value": 0.0102, "unit": "rad/s"}, "iterations": 9, "note": "converged"}},
    "observers": {
        "observer_1": observer(1.0),
        "observer_2": observer(1.2),
        "baselines": {"motor_speed": {"speed_load": errors(0.61, 5.0)}, "no_backlash": observer(11.0)},
    },
    "design": {
        "torque_limit": {"value": 73.5, "unit": "Nm", "source": "largest recorded motor torque"},
        "poles": {"value": ["-230 + 588j", "-230 − 588j", "-124"], "unit": "1/s", "source": "from the drive"},
        "pi_kp": {"value": 13.4, "unit": "Nm s/rad", "source": "symmetrical optimum"},
        "step": {"value": [-2.0, 2.0], "unit": "rad/s", "source": "recorded speeds"},
    },
    "controllers": {"pi": metrics(8.63), "pole_placement": metrics(0.42)},
    "export": {"max_difference": 0.0, "compiler": "cc 12.2"},
    "stability": {
        "headline": "Proved: from 0.2 rad/s.",
        "facts": [["Returns to its rest", "from 0.2 rad/s on"]],
        "proved": True,
        "conditions": ["nothing touches it"],
    },
    "problems": [
        {"severity": "warning", "where": "chan", "got": "few", "expected": "many", "remedy": "Record longer."}
    ],
    "timing_s": {"read": 0.3, "identify": 1.7},
}


class Balanced(HTMLParser):
    """Collects text, ids and addresses; fails where a tag is closed that was not opened."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text: list[str] = []
        self.ids: list[str] = []
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag not in VOID:
            self.open.append(tag)
        for key, value in attrs:
            if key in ("src", "href", "data", "poster", "srcset", "action"):
                self.addresses.append(value or "")
            if key == "id":
                self.ids.append(value or "")

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open.pop() == tag, tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text.append(data)

    @property
    def words(self) -> str:
        return re.sub(r"\s+", " ", " ".join(self.text))


def figure(points: int = 50, style: str = "-") -> Figure:
    made = Figure()
    made.subplots().plot(np.random.default_rng(2).standard_normal(points), style)
    return made


def test_the_page_contains_every_part():
    page = Balanced(
        render(RESULTS, [("A title", "A caption", figure(), "observers")], command="lostmotion run x")
    )
    for text in (
        "PI: 8.6 % at 38.2 Nm", "12.13 mrad", "12.05 … 12.21", "outside", "not excited", "nameplate",
        "Load speed Observer 1", "Shaft torque Observer 1", "Observer 2",
        "Motor speed taken as estimate", "Observer without backlash",
        "0.16 %", "1.2 %", "20 µs", "does not settle within 2 %", "38.2 Nm", "bit-equal", "cc 12.2",
        "Record longer.", "ab" * 32, "seed 7", "lostmotion 0.1.0", "lostmotion run x", "1.7 s", "converged",
        "A title.", "A caption", "20 000", "PI, symmetrical optimum",
        "Proved stable", "Returns to its rest from 0.2 rad/s on", "Valid while nothing touches it",
        "largest recorded motor torque", "-230 − 588j, -124 1/s",
    ):  # fmt: skip
        assert text in page.words, text
    assert "Skipped" not in page.words
    assert "None" not in page.words.replace("None.", "") and "nan" not in page.words


def test_the_page_is_self_contained():
    page = render(RESULTS, [("t", "c", figure()), ("t", "c", figure(200_000)), ("t", "c", "<svg/>")])
    parsed = Balanced(page)
    assert len(set(parsed.ids)) == len(parsed.ids)
    assert parsed.addresses
    for address in parsed.addresses:
        assert address.startswith("data:image/") or address.removeprefix("#") in parsed.ids, address[:60]
    assert "@import" not in page and "url(" not in page
    assert not {"script", "link", "iframe", "object"} & set(parsed.tags)


def test_large_figures_become_png_and_small_ones_svg():
    assert ReportFigure("t", "c", figure(50)).uri.startswith("data:image/svg+xml;base64,")
    large = ReportFigure("t", "c", figure(20_000, ".")).uri
    assert large.startswith("data:image/png;base64,") and len(large) < 2 * MAX_SVG_BYTES


def test_a_figure_is_the_same_in_every_run():
    assert ReportFigure("t", "c", figure()).uri == ReportFigure("t", "c", figure()).uri


def test_simulated_is_said_only_where_it_is():
    assert "simulated: virtual rig" in Balanced(render(RESULTS)).words
    real = {**RESULTS, "truth": {"skipped": "real recording"}}
    page = Balanced(render(real)).words
    assert "virtual rig" not in page and "Truth" not in page
    assert (
        "finer than the identified model, its parameters varied within the 95 % intervals" in page
        and "Controllers simulated" in page
    )


@pytest.mark.parametrize(
    "part", ["recordings", "parameters", "truth", "fits", "observers", "controllers", "stability", "export"]
)
def test_a_skipped_part_shows_its_reason(part):
    page = Balanced(render({**RESULTS, part: {"skipped": "because of the moon"}})).words
    assert ("because of the moon" in page) == (part != "truth")


@pytest.mark.parametrize("part", sorted(RESULTS))
def test_a_missing_part_is_survived(part):
    Balanced(render({key: value for key, value in RESULTS.items() if key != part}))


def test_everything_skipped_and_nothing_at_all():
    page = Balanced(
        render({key: {"skipped": f"reason {key}"} for key in RESULTS if key not in ("seed", "problems")})
    )
    assert "No stage gave a result." in page.words and "reason observers" in page.words
    Balanced(render({}))


def leaves(node: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    if isinstance(node, dict):
        return [leaf for key, value in node.items() for leaf in [(*path, key), *leaves(value, (*path, key))]]
    return [path] if path else []


@pytest.mark.parametrize(
    ("kind", "replacement"),
    [((dict, list, str, int, float), None), (dict, {"skipped": "reason"}), (float, float("nan"))],
    ids=["null", "skipped", "nan"],
)
def test_any_single_entry_may_be_null_skipped_or_not_a_number(kind, replacement):
    tried = 0
    for path in dict.fromkeys(leaves(RESULTS)):
        results = copy.deepcopy(RESULTS)
        node = results
        for key in path[:-1]:
            node = node[key]
        if isinstance(node[path[-1]], kind):
            node[path[-1]] = replacement
            words = Balanced(render(results)).words
            assert not re.search(r"\bnan\b", words), path
            tried += 1
    assert tried > 10


def test_an_entry_skipped_among_the_parameters_is_no_parameter():
    parameters = {**RESULTS["parameters"], "identification": {"skipped": "no motor torque"}}
    page = Balanced(render({**RESULTS, "parameters": parameters})).words
    assert "Parameters identified 2 of 4" in page
    assert "Parameters: Identification no motor torque" in page


def test_a_value_that_was_not_excited_is_neither_zero_nor_none():
    parameters = {
        "backlash": {"value": None, "low": None, "high": None, "unit": "rad", "source": "not excited"}
    }
    page = Balanced(render({"parameters": parameters})).words
    assert "Backlash not excited" in page
    assert "0 mrad" not in page and "0 rad" not in page


def test_user_text_is_escaped(tmp_path):
    bad = "<script>alert(1)</script>"
    results = {
        **RESULTS,
        "inputs": {bad: bad},
        "version": bad,
        "problems": [dict.fromkeys(("severity", "where", "got", "expected", "remedy"), bad)],
        "fits": {bad: {bad: bad}},
        "observers": {"skipped": bad},
        "recordings": {bad: {"signals": [bad], "file": bad, "origin": bad}},
        "controllers": {"pi": metrics(1.0), "plant": bad},
        "export": {"compiler": bad, "max_difference": 1e-3, bad: bad},
    }
    svg = f"<svg xmlns='http://www.w3.org/2000/svg'>{bad}</svg>"
    path = write_report(tmp_path / "r.html", results, [(bad, bad, svg)], title=bad, command=bad)
    page = path.read_text(encoding="utf-8")
    assert "<script" not in page
    assert bad in Balanced(page).words


def card(results: dict[str, Any], label: str) -> dict[str, str]:
    return next(c for c in cards(results) if label in c["label"])


@pytest.mark.parametrize(
    ("signal", "label"), [("speed_load", "Load speed"), ("torque_shaft", "Shaft torque")]
)
def test_an_observer_is_green_only_where_it_beats_every_naive_estimate(signal, label):
    assert card(RESULTS, label)["state"] == "good"
    beaten = copy.deepcopy(RESULTS)
    beaten["observers"]["baselines"]["no_backlash"][signal] = dict(
        beaten["observers"]["observer_1"][signal],
        rmse=0.9 * beaten["observers"]["observer_1"][signal]["rmse"],
    )
    assert card(beaten, label)["state"] == "bad"
    assert "observer without backlash" in card(beaten, label)["note"]
    alone = copy.deepcopy(RESULTS)
    alone["observers"]["baselines"] = {}
    assert card(alone, label)["state"] == "plain"


@pytest.mark.parametrize(
    ("overshoot", "torque", "state"),
    [(0.4, 38.0, "good"), (0.4, 73.5, "plain"), (9.0, 38.0, "plain"), (12.0, 38.0, "bad")],
)
def test_less_overshoot_is_green_only_without_more_torque(overshoot, torque, state):
    results = copy.deepcopy(RESULTS)
    results["controllers"]["pole_placement"] |= {"overshoot": overshoot, "peak_torque": torque}
    found = card(results, "Overshoot")
    assert found["state"] == state
    assert f"{torque:.1f}" in found["note"] and "at 38.2\u00a0Nm" in found["note"]


def test_an_observer_without_a_signal_to_judge_it_says_why():
    alone = copy.deepcopy(RESULTS)
    reason = {"skipped": "no speed_load in the recording"}
    for entry in (alone["observers"]["observer_1"], *alone["observers"]["baselines"].values()):
        entry["speed_load"] = reason
    assert card(alone, "Load speed")["note"] == "no speed_load in the recording"
    words = Balanced(render(alone)).words
    assert "1 part skipped" in words and "Observers: Observer 1: Load speed" in words


def test_wide_tables_stack_on_a_narrow_screen():
    """Every table of more than two columns: each cell but the first, which is the row's name, says what it is."""
    page = render(RESULTS)
    assert "table.stack td[data-head]::before" in page
    tables = re.findall(r"<table.*?</table>", page, re.DOTALL)
    wide = [table for table in tables if len(re.findall("<th[ >]", table.partition("</thead>")[0])) > 2]
    assert len(wide) >= 5
    for table in wide:
        body = table[table.index("<tbody>") :]
        assert table.startswith('<table class="stack">'), table[:200]
        for row in body.split("<tr")[1:]:
            cells = re.findall(r"<td[^>]*>", row)
            assert all("data-head=" in cell for cell in cells[1:]), row


def test_the_observers_are_explained_before_their_first_number():
    words = Balanced(render(RESULTS)).words
    assert words.index("Observer 2 measures the shaft torque") < words.index("Load speed error, Observer 1")


def test_the_first_problem_stands_beside_what_is_praised():
    problem = {
        "severity": "warning",
        "where": "torque_motor",
        "got": "one",
        "expected": "two",
        "remedy": "Check it.",
    }
    page = render({**RESULTS, "problems": [problem, {**problem, "where": "other"}]})
    assert "First of 2 problems: torque_motor: one. Check it." in page
    assert "One problem: torque_motor" in render({**RESULTS, "problems": [problem]})
    assert "problem: " not in render({**RESULTS, "problems": []})

"""What the zoo's benchmark makes of a drive and of its lines."""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import lostmotion as lm

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))
import shared
import zoo_gap_bound
import zoo_observer
import zoo_shares
import zoo_tables
import zoo_targets

#: A third of the virtual rig's frequency, a gap of 0.4 wind-ups, no load torque.
DRIVE = lm.rig.drive(403)
TRUTH = zoo_observer.true_values(DRIVE)


def judged(sources: dict[str, str] | None = None, **changes: float) -> dict[str, float | None] | None:
    """Errors of Observer 1 with the true equivalents, some of them changed."""
    told = {**dict.fromkeys(TRUTH, "identified"), **(sources or {})}
    found: Any = SimpleNamespace(sources=told, drivetrain=lm.Drivetrain.two_mass(**{**TRUTH, **changes}))
    return zoo_observer.observer_errors(DRIVE, found)


def test_observer_1_on_a_drive_of_another_size_in_its_own_units():
    right, wrong = judged(), judged(inertia_load=1.3 * TRUTH["inertia_load"])
    assert right is not None and right["identified"] == right["true"] is not None
    assert right["true"] < 0.001  # in SI it would be twice that
    assert wrong is not None and wrong["true"] == right["true"]
    assert wrong["identified"] is not None and wrong["identified"] > 3.0 * right["true"]


def test_observer_1_is_judged_where_its_parameters_are_identified():
    assert judged({"backlash": "not excited"}) is None and judged({"stiffness": "nameplate"}) is None
    assert judged({"coulomb": "not excited"}) is not None


def errors(identified: float | None, true: float | None, load_torque: str = "none") -> dict[str, Any]:
    return {
        "observer": {"identified": identified, "true": true},
        "dimensions": {"load_torque": load_torque},
    }


def test_an_observer_that_cannot_be_made_counts():
    nine = [errors(0.004, 0.002)] * 9
    unjudged = errors(0.004, 0.002) | {"observer": None}
    numbers = zoo_observer.observer_numbers([*nine, unjudged, errors(None, None)])["all"]
    assert numbers["drives"] == 9 and numbers["fine_identified"] == 1.0
    assert numbers["error_90_true"] == 0.002 and numbers["ratio_90"] == pytest.approx(2.0)
    both = zoo_observer.observer_numbers([*nine, errors(None, 0.002, "slow")])
    assert both["all"]["fine_identified"] == 0.9 and both["all"]["fine_true"] == 1.0
    assert both["all"]["ratio_90"] == float("inf") and both["without load torque"] == numbers


def line(gap: float, bound: float | None, **found: Any) -> dict[str, Any]:
    """A line of results of a drive with this gap and this bound, rad; the Cramér–Rao limit is 0.001 of either."""
    return {
        "truth": {"backlash": gap}, "bound": {"backlash": 0.001}, "gap_bound": bound, "found": found, "absent": [],
        "dimensions": dict(DRIVE.dimensions), "time": 1.0, "observer": {"identified": 0.004, "true": 0.002},
    }  # fmt: skip


def test_the_bound_of_a_gap_and_what_the_limit_allows():
    intervals = {"backlash": (0.0, 0.002)}
    told: Any = SimpleNamespace(sources={"backlash": "not excited"}, intervals=intervals)
    assert zoo_gap_bound.gap_bound(told) == 0.002
    told.sources["backlash"] = "identified"
    assert zoo_gap_bound.gap_bound(told) is None
    rigid = line(0.0, None) | {"absent": ["backlash"]}
    wrong = {"value": 0.01, "interval": [0.009, 0.011]}
    entries = [line(0.0, 0.002), line(0.0, 0.004), line(0.0, None, backlash=wrong), line(0.003, 0.002), rigid]
    numbers = zoo_gap_bound.gap_bound_numbers([*entries, line(0.003, 0.004)])
    assert numbers["without"] == {"drives": 3, "given": 2, "holds": 2, "identified": 1, "ratio_median": 3.0}
    assert (numbers["with"]["given"], numbers["with"]["holds"]) == (2, 1)
    shown = zoo_tables.tables(zoo_tables.Scores(entries))
    assert (
        "| without a gap | 3 | 2 | 2 | 1 | 3 |" in shown
        and "| all | 5 | 100 | 0.4 | 100 | 0.2 | 2 |" in shown
    )


def judged_line(value: float, half: float, **kind: Any) -> dict[str, Any]:
    """A line of a drive with a stiffness of 1, and what is found of it."""
    found = {"value": value, "interval": [value - half, value + half]}
    entry = line(0.0, None, stiffness=found)
    entry |= {"truth": {"stiffness": 1.0, "backlash": 0.0}, "bound": {"stiffness": 0.001, "backlash": 0.001}}
    usual = {"excitation": "designed", "gap": 1.0, "bits": 20.0}
    return entry | {"dimensions": entry["dimensions"] | usual | kind}


def targets(entries: list[dict[str, Any]]) -> dict[str, tuple[str, int, bool]]:
    lines = zoo_targets.target_lines(zoo_tables.Scores(entries))
    return {text: (measured, count, met) for text, _, measured, count, met in lines}


def test_targets_say_what_is_measured_and_whether_it_is_met():
    right, none = judged_line(1.001, 0.002), judged_line(1.0, 0.002) | {"found": {}}
    met = targets([right] * 19 + [judged_line(1.004, 0.002)])
    assert met["coverage, %"] == ("95", 20, True) and met["grossly wrong, %"] == ("0", 20, True)
    assert met["stiffness identified, target group, %"] == ("100", 20, True)
    assert met["stiffness, 90 % of errors, designed, %"] == ("0.1", 20, True)
    assert met["half width over error, median"] == ("2", 20, True)
    missed = targets([right] * 8 + [none, judged_line(1.4, 0.002) | {"time": 21.0}])
    assert missed["coverage, %"] == ("88.9", 9, False)
    assert missed["grossly wrong, %"] == ("11.1", 9, False)
    assert missed["stiffness identified, target group, %"] == ("90", 10, True)
    assert missed["stiffness, 90 % of errors, designed, %"] == ("8.08", 9, False)
    assert missed["drives within 20 s, %"] == ("90", 10, False)
    assert "| coverage, % | 93 … 98 | 88.9 | 9 | **no** |" in zoo_targets.target_table(
        zoo_targets.target_lines(zoo_tables.Scores([right] * 8 + [judged_line(1.4, 0.002)]))
    )


@pytest.mark.parametrize(
    ("kind", "inside"),
    [
        ({}, True),
        ({"bits": 0.0}, True),
        ({"bits": 15.0}, False),
        ({"gap": 0.0}, False),
        ({"excitation": "prbs"}, False),
    ],
)
def test_the_target_group_has_a_gap_a_designed_excitation_and_no_coarse_encoder(
    kind: dict[str, Any], inside: bool
):
    assert zoo_targets.in_target_group(judged_line(1.0, 0.1, **kind)) == inside


def test_low_cells_are_those_that_the_table_marks():
    entries = [judged_line(1.0, 0.01, masses=2.0)] * 30 + [judged_line(1.02, 0.01, masses=5.0)] * 5
    scores = zoo_tables.Scores(entries)
    low = zoo_tables.low_cells(scores)
    assert "masses 5" in low and "masses 2" not in low
    assert zoo_tables.tables(scores).count("**low**") == len(low)


def test_shares_count_what_the_recording_shows():
    found, missed = judged_line(1.0, 0.01), judged_line(1.0, 0.01, masses=7.0) | {"found": {}}
    hidden = missed | {"bound": {"stiffness": 0.2, "backlash": 0.001}}
    gapless = judged_line(1.0, 0.01, gap=0.0)
    shown = zoo_shares.share_table(zoo_tables.Scores([found, missed, hidden, gapless]))
    assert {"| all | 3 | 67 |", "| masses 7 | 1 | 0 |", "| without a gap | 1 | 100 |"} <= set(shown)


def test_results_are_read_packed_or_not(tmp_path: Path):
    lines = "".join(json.dumps({"seed": seed}) + "\n" for seed in (1, 2))
    (tmp_path / "plain.jsonl").write_text(lines)
    (tmp_path / "packed.jsonl.gz").write_bytes(gzip.compress(lines.encode()))
    for name in ("plain.jsonl", "packed.jsonl.gz"):
        assert shared.read(tmp_path / name) == [{"seed": 1}, {"seed": 2}], name
    assert shared.read(tmp_path / "none.jsonl") == []

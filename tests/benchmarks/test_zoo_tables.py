"""What the zoo's benchmark makes of a drive and of its lines."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import lostmotion as lm

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))
import zoo_gap_bound
import zoo_observer
import zoo_tables

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

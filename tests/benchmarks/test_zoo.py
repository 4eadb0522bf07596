"""What the zoo's benchmark makes of a drive and of its lines."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import lostmotion as lm

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))
import zoo_observer

#: A third of the virtual rig's frequency, a gap of 0.4 wind-ups, no load torque.
DRIVE = lm.rig.drive(403)
TRUTH = {name: max(value or 0.0, 0.0) for name, value in DRIVE.truth.parameters.items()}


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


def test_an_observer_that_cannot_be_made_counts():
    one: dict[str, Any] = {"observer": {"identified": 0.004, "true": 0.002}}
    nine = [one] * 9
    numbers = zoo_observer.observer_numbers(
        [*nine, {"observer": None}, {}, {"observer": {"identified": None, "true": None}}]
    )
    assert numbers["drives"] == 9 and numbers["fine_identified"] == 1.0
    assert numbers["error_90_true"] == 0.002 and numbers["ratio_90"] == pytest.approx(2.0)
    numbers = zoo_observer.observer_numbers([*nine, {"observer": {"identified": None, "true": 0.002}}])
    assert numbers["fine_identified"] == 0.9 and numbers["fine_true"] == 1.0
    assert numbers["ratio_90"] == float("inf")

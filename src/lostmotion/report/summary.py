"""The top of the report: the headline, what is missing, the first problem, and cards with the key numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..display.numbers import NONE, digits, half_width, is_number, percent, with_interval
from ..drivetrain import PARAMETER_UNITS
from . import tables
from .headline import headline
from .tables import mapping, parameters, skip_reason, skipped, words


def is_simulated(results: Mapping[str, Any]) -> bool:
    """Whether the recordings come from the virtual rig: only then is there a truth."""
    return bool(mapping(results.get("truth")))


def lead(results: Mapping[str, Any]) -> str:
    """The headline, how much was skipped, and the first problem."""
    missing = len(skipped(results))
    remark = f" {_count(missing, 'part')} skipped, with the reason below." if missing else ""
    return headline(results) + remark + _first_problem(results)


def _first_problem(results: Mapping[str, Any]) -> str:
    """The first problem: results list the most important one first."""
    problems = [mapping(problem) for problem in results.get("problems") or ()]
    if not problems:
        return ""
    first = problems[0]
    lead = f"First of {_count(len(problems), 'problem')}" if len(problems) > 1 else "One problem"
    return f" {lead}: {first.get('where')}: {first.get('got')}. {first.get('remedy')}"


def cards(results: Mapping[str, Any]) -> list[dict[str, str]]:
    """Key numbers: label, value, note, and state ("good", "bad", "plain", "none")."""
    found = [
        _parameter_card(results),
        _value_card(results, "backlash", "Backlash (total free angle)"),
        _value_card(results, "stiffness", "Shaft stiffness"),
        _observer_card(results, "speed_load", "Load speed error, Observer 1", "motor_speed"),
        _observer_card(results, "torque_shaft", "Shaft torque error, Observer 1", "no_backlash"),
        _control_card(results),
        _export_card(results),
        _problem_card(results),
    ]
    if skip_reason(results.get("observers")) is not None:
        found[3:5] = _fit_cards(results)
    return [dict(zip(("label", "value", "note", "state"), card, strict=True)) for card in found]


Card = tuple[str, str, str, str]


def _missing(label: str, part: Any) -> Card:
    return (
        label,
        "skipped" if skip_reason(part) else "–",
        skip_reason(part) or "not part of this run",
        "none",
    )


def _parameter_card(results: Mapping[str, Any]) -> Card:
    rows, label = parameters(results), "Parameters identified"
    if not rows:
        return _missing(label, results.get("parameters"))
    counts = {
        kind: sum(r["source"] == kind for r in rows) for kind in ("identified", "nameplate", "not excited")
    }
    notes = [f"{counts[kind]} {kind}" for kind in ("nameplate", "not excited") if counts[kind]]
    return (
        label,
        f"{counts['identified']} of {len(rows)}",
        ", ".join(notes) or "each with a 95 % interval",
        "plain",
    )


def _value_card(results: Mapping[str, Any], name: str, label: str) -> Card:
    found = mapping(results.get("parameters"))
    entry = mapping(found.get(name))
    value, low, high = (entry.get(key) for key in ("value", "low", "high"))
    if not entry:
        return _missing(label, found.get(name) or results.get("parameters"))
    if not is_number(value):
        return (label, "not excited", "not identified from this recording", "none")
    note, half = str(entry.get("source") or ""), half_width(value, low, high)
    shown = with_interval(value, low, high, entry.get("unit") or PARAMETER_UNITS.get(name, ""))[0]
    return (label, shown, note if half == NONE else f"{note}, {half} (95 %)", "plain")


def _fit_cards(results: Mapping[str, Any]) -> list[Card]:
    """The first fits with an interval, where no observer was validated; at most three (chosen)."""
    cards: list[Card] = []
    for name, fit in mapping(results.get("fits")).items():
        for key, entry in mapping(fit).items():
            value, low, high = (mapping(entry).get(k) for k in ("value", "low", "high"))
            half = half_width(value, low, high)
            if half != NONE and key not in mapping(results.get("parameters")):
                shown = with_interval(value, low, high, str(entry.get("unit") or ""))[0]
                cards.append((f"{words(name)}: {key}".replace("_", " "), shown, f"{half} (95 %)", "plain"))
    return cards[:3]


def _observer_card(results: Mapping[str, Any], signal: str, label: str, naive: str) -> Card:
    share, other = (tables.error_of(results, group, signal) for group in ("observer_1", naive))
    if share is None:
        observers = results.get("observers")
        return _missing(label, observers if skip_reason(observers) else mapping(observers).get("observer_1"))
    note, state = "RMSE, of the range", "plain"
    if other is not None:
        name = {"motor_speed": "motor speed as estimate", "no_backlash": "observer without backlash"}[naive]
        note, state = f"of the range; {name}: {percent(other)}", "good" if share < other else "bad"
    return (label, percent(share), note, state)


def _control_card(results: Mapping[str, Any]) -> Card:
    label, new, old = (
        "Overshoot, pole placement",
        tables.overshoot_of(results, "pole_placement"),
        tables.overshoot_of(results, "pi"),
    )
    if new is None:
        return _missing(label, results.get("controllers"))
    note = "of the step, simulated" + ("" if old is None else f"; PI: {percent(old / 100.0)}")
    return (label, percent(new / 100.0), note, "plain" if old is None else "good" if new < old else "bad")


def _export_card(results: Mapping[str, Any]) -> Card:
    export = mapping(results.get("export"))
    difference = export.get("max_difference")
    if not export:
        return _missing("C code against Python", results.get("export"))
    if not is_number(difference):
        return (
            "C code against Python",
            "not run",
            str(export.get("compiler") or "no C compiler found"),
            "none",
        )
    value = "bit-equal" if difference == 0 else f"differs by {digits(difference, 2)}"
    return (
        "C code against Python",
        value,
        str(export.get("compiler") or ""),
        "good" if difference == 0 else "bad",
    )


def _problem_card(results: Mapping[str, Any]) -> Card:
    problems = list(results.get("problems") or ())
    errors = sum(mapping(p).get("severity") == "error" for p in problems)
    warnings = len(problems) - errors
    note = f"{_count(errors, 'error')}, {_count(warnings, 'warning')}" if problems else "nothing found"
    return ("Problems", str(len(problems)), note, "bad" if errors else "plain" if problems else "good")


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" + ("" if number == 1 else "s")

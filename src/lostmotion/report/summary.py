"""The top of the report below the headline: what is missing, the first problem, and cards with the key numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..display.numbers import NONE, digits, half_width, is_number, percent, quantity, with_interval
from ..drivetrain import PARAMETER_UNITS
from . import tables
from .tables import mapping, parameters, skip_reason, skipped, words


def is_simulated(results: Mapping[str, Any]) -> bool:
    """Whether the recordings come from the virtual rig: only then is there a truth."""
    return bool(mapping(results.get("truth")))


def remarks(results: Mapping[str, Any]) -> str:
    """How much was skipped, and the first problem."""
    missing = len(skipped(results))
    remark = f"{_count(missing, 'part')} skipped, with the reason below." if missing else ""
    return (remark + _first_problem(results)).strip()


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
        _observer_card(results, "speed_load", "Load speed error, Observer 1"),
        _observer_card(results, "torque_shaft", "Shaft torque error, Observer 1"),
        _control_card(results),
        _export_card(results),
        _problem_card(results),
    ]
    if skip_reason(results.get("observers")) is not None:
        found[3:5] = _fit_cards(results)
    return [dict(zip(("label", "value", "note", "state"), card, strict=True)) for card in found]


#: Overshoot (%) from which on more than the other law's is bad (option: the project's target).
MUCH_OVERSHOOT = 10.0

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


def _observer_card(results: Mapping[str, Any], signal: str, label: str) -> Card:
    """Green only if the observer beats every naive estimate."""
    share = tables.error_of(results, "observer_1", signal)
    if share is None:
        observers = results.get("observers")
        first = mapping(observers).get("observer_1")
        parts = (observers, first, mapping(first).get(signal))
        return _missing(label, next((part for part in parts if skip_reason(part)), first))
    naive = tables.best_naive(results, signal)
    if naive is None:
        return (label, percent(share), "RMSE, of the range", "plain")
    note = f"of the range; best naive estimate, {naive[0]}: {percent(naive[1])}"
    return (label, percent(share), note, "good" if share < naive[1] else "bad")


def _control_card(results: Mapping[str, Any]) -> Card:
    """Overshoot together with peak torque: less of the one for more of the other is no merit of the law."""
    label = "Overshoot, pole placement"
    new, old = (tables.overshoot_of(results, name) for name in ("pole_placement", "pi"))
    if new is None:
        return _missing(label, results.get("controllers"))
    torque, other = (tables.peak_torque_of(results, name) for name in ("pole_placement", "pi"))
    note, state = "of the step, simulated", "plain"
    if torque is not None:
        note += f", at {quantity(torque, 'Nm')} of peak torque"
    if old is not None:
        note += f"; PI: {percent(old / 100.0)}"
        note += "" if other is None else f" at {quantity(other, 'Nm')}"
        better = new < old and torque is not None and other is not None and torque <= other
        state = "good" if better else "bad" if new > max(old, MUCH_OVERSHOOT) else "plain"
    return (label, percent(new / 100.0), note, state)


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

"""The report's headline: what the user may rely on and what not, from the results alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from ..display.numbers import is_number, percent
from ..drivetrain import PARAMETER_UNITS
from . import tables
from .tables import mapping, skip_reason

#: Half width of the 95 % interval over the value up to which a parameter counts as reliable (option: just above the
#: targets of the identification, 1 to 4 %).
RELIABLE = 0.05

_PARAMETERS = {
    "inertia_motor": "motor inertia",
    "inertia_load": "load inertia",
    "coulomb": "Coulomb friction",
    "viscous": "viscous friction",
    "coulomb_motor": "the motor's Coulomb friction",
    "viscous_motor": "the motor's viscous friction",
    "lag": "torque lag",
}
#: Signals by which Observer 1 is judged, the first one that was recorded, and the naive estimate it must beat.
_JUDGED_BY = (("speed_load", "motor_speed"), ("torque_shaft", "no_backlash"))


def headline(results: Mapping[str, Any]) -> str:
    """What the user may rely on, one sentence each on parameters, observer and controller, as far as there are results.

    Parameters
    ----------
    results : mapping
        As in ``results.json``.
    """
    sentences = [*_parameters(results), *_observer(results), *_controller(results), *_code(results)]
    return " ".join(sentences) if sentences else "No stage gave a result."


def _parameters(results: Mapping[str, Any]) -> Iterator[str]:
    """Which parameters are identified and how well, which are uncertain, given, or not identified."""
    entries = {name: mapping(entry) for name, entry in mapping(results.get("parameters")).items()}
    known = [name for name in PARAMETER_UNITS if entries.get(name)]
    widths = {name: _relative_half_width(entries[name]) for name in known}
    reliable = [name for name in known if (w := widths[name]) is not None and w <= RELIABLE]
    uncertain = [name for name in known if (w := widths[name]) is not None and w > RELIABLE]
    others = [name for name in known if widths[name] is None]
    given = [name for name in others if entries[name].get("source") == "nameplate"]
    missing = [name for name in others if entries[name].get("source") == "not excited"]
    clauses = []
    if reliable:
        largest = max(w for name in reliable if (w := widths[name]) is not None)
        clauses.append(f"{_list(reliable)} {_are(reliable)} identified within ±{percent(largest)}")
    if uncertain:
        remarks = {name: f" (±{percent(widths[name])})" for name in uncertain}
        clauses.append(f"{_list(uncertain, remarks)} {_are(uncertain)} uncertain")
    if given:
        clauses.append(f"{_list(given)} {_are(given)} taken from the nameplate")
    if missing:
        clauses.append(f"{_list(missing)} {_are(missing)} not identified")
    if clauses:
        yield _sentence("; ".join(clauses))


def _observer(results: Mapping[str, Any]) -> Iterator[str]:
    """How well Observer 1 estimates what it does not measure, or that it does no better than a naive estimate."""
    name = "Observer 1, the Kalman observer that measures the motor speed alone,"
    for signal, naive in _JUDGED_BY:
        error, naive_error = (tables.error_of(results, group, signal) for group in ("observer_1", naive))
        if error is None:
            continue
        words = tables.signal_words(signal).lower()
        if naive_error is not None and error >= naive_error:
            naive_words = tables.words(naive).lower()
            yield f"{name} does not beat {naive_words} for the {words}: {percent(error)} of its range."
        else:
            yield f"{name} follows the {words} with an error of {percent(error)} of its range."
        return


def _controller(results: Mapping[str, Any]) -> Iterator[str]:
    """How far the load speed overshoots in simulation, or that the controller must not be used."""
    controllers = mapping(results.get("controllers"))
    reason = skip_reason(controllers.get("pole_placement"))
    new, old = tables.overshoot_of(results, "pole_placement"), tables.overshoot_of(results, "pi")
    if reason is not None:
        yield f"There is no controller to use: {reason}."
    elif new is not None:
        against = "" if old is None else f" and {percent(old / 100.0)} under PI"
        yield f"In simulation the load speed overshoots by {percent(new / 100.0)} with pole placement{against}."
    elif mapping(controllers.get("pole_placement")):
        yield "In simulation the load speed does not reach the set-point with pole placement."


def _code(results: Mapping[str, Any]) -> Iterator[str]:
    difference = mapping(results.get("export")).get("max_difference")
    if is_number(difference) and difference != 0:
        yield "Do not use the C code: it differs from Python."


def _relative_half_width(entry: Mapping[str, Any]) -> float | None:
    """Half the 95 % interval over the value; None without an interval, or for a value of zero."""
    value, low, high = (entry.get(key) for key in ("value", "low", "high"))
    if not (is_number(value) and is_number(low) and is_number(high)) or value == 0:
        return None
    return 0.5 * abs((high - low) / value)


def _list(names: Sequence[str], remarks: Mapping[str, str] | None = None) -> str:
    """Names in words: "a, b and c", each with its remark."""
    shown = [_PARAMETERS.get(name, name) + (remarks or {}).get(name, "") for name in names]
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


def _are(names: Sequence[str]) -> str:
    return "is" if len(names) == 1 else "are"


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."

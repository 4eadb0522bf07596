"""The report's headline: one sentence on what the user may rely on and what not, from the results alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..display.numbers import is_number, percent, quantity
from ..drivetrain import PARAMETER_UNITS
from . import tables
from .tables import mapping, skip_reason

#: Half width of the 95 % interval over the value up to which a parameter counts as reliable (option: just above the
#: targets of the identification, 1 to 4 %).
RELIABLE = 0.05

_PARAMETERS = {
    "inertia_motor": "motor inertia",
    "inertia_load": "load inertia",
    "inertia_total": "total inertia",
    "coulomb": "Coulomb friction",
    "viscous": "viscous friction",
    "coulomb_motor": "the motor's Coulomb friction",
    "viscous_motor": "the motor's viscous friction",
    "lag": "torque lag",
}
#: Signals by which Observer 1 is judged: the first one that was recorded.
_JUDGED_BY = ("speed_load", "torque_shaft")
#: Steady error (fraction of the step) and overshoot (%) up to which a law is relied on (option: the project's target).
STEADY, OVERSHOOT = 0.005, 10.0


@dataclass(frozen=True)
class _Verdict:
    """A thing in words, with the number that says so, and whether the user may rely on it."""

    text: str
    reliable: bool


def headline(results: Mapping[str, Any]) -> str:
    """What the user may rely on and what not, in one sentence.

    Parameters
    ----------
    results : mapping
        As in ``results.json``.
    """
    verdicts = [*_parameters(results), *_observer(results), *_controller(results), *_code(results)]
    sure = [verdict.text for verdict in verdicts if verdict.reliable]
    unsure = [verdict.text for verdict in verdicts if not verdict.reliable]
    if sure and unsure:
        return f"You may rely on {_list(sure)}, but not on {_list(unsure)}."
    if sure:
        return f"You may rely on {_list(sure)}."
    return f"Do not rely on {_list(unsure)}." if unsure else "No stage gave a result."


def _parameters(results: Mapping[str, Any]) -> Iterator[_Verdict]:
    """The parameters that are known well, those that are not, and those that were not identified."""
    entries = {name: mapping(entry) for name, entry in mapping(results.get("parameters")).items()}
    known = [name for name in (*PARAMETER_UNITS, "inertia_total") if entries.get(name)]
    widths = {name: _relative_half_width(entries[name]) for name in known}
    reliable = [name for name in known if (w := widths[name]) is not None and w <= RELIABLE]
    if {"inertia_motor", "inertia_load"} <= set(reliable):  # both parts say more than the sum
        known, reliable = ([name for name in names if name != "inertia_total"] for names in (known, reliable))
    if reliable:
        largest = max(w for name in reliable if (w := widths[name]) is not None)
        yield _Verdict(f"{_list([_words(name) for name in reliable])} (±{percent(largest)})", True)
    reasons = {"nameplate": "from the nameplate", "not excited": "not identified"}
    for name in known:
        if name in reliable:
            continue
        width, source = widths[name], str(entries[name].get("source"))
        reason = reasons.get(source) if width is None else f"±{percent(width)}"
        if reason is not None:
            yield _Verdict(f"{_words(name)} ({reason})", False)


def _observer(results: Mapping[str, Any]) -> Iterator[_Verdict]:
    """Observer 1, by the first signal that was recorded: it counts only if it beats every naive estimate."""
    for signal in _JUDGED_BY:
        error = tables.error_of(results, "observer_1", signal)
        if error is None:
            continue
        words = f"the {tables.signal_words(signal).lower()} that Observer 1 estimates from motor torque and motor speed"
        naive = tables.best_naive(results, signal)
        if naive is not None and error >= naive[1]:
            yield _Verdict(
                f"{words} (error {percent(error)} of its range; {naive[0]}: {percent(naive[1])})", False
            )
        else:
            yield _Verdict(f"{words} (error {percent(error)} of its range)", True)
        return


def _controller(results: Mapping[str, Any]) -> Iterator[_Verdict]:
    """The target's law in simulation: its overshoot always together with its peak torque."""
    law = mapping(results.get("controllers")).get("pole_placement")
    reason, figures = skip_reason(law), mapping(law)
    if reason is not None:
        yield _Verdict(f"the control law ({reason})", False)
    elif figures:
        overshoot, steady = figures.get("overshoot"), figures.get("steady_error")
        settles = is_number(figures.get("settling_time")) and is_number(steady) and steady <= STEADY
        if is_number(overshoot) and overshoot <= OVERSHOOT and settles:
            peak = quantity(figures.get("peak_torque"), "Nm")
            yield _Verdict(
                f"the control law (in simulation {percent(overshoot / 100.0)} overshoot at {peak})", True
            )
        elif is_number(overshoot):
            remark = f"{percent(overshoot / 100.0)} overshoot, steady error {percent(steady)}"
            yield _Verdict(f"the control law (in simulation {remark})", False)
        else:
            yield _Verdict("the control law (in simulation the load does not reach the set-point)", False)


def _code(results: Mapping[str, Any]) -> Iterator[_Verdict]:
    difference = mapping(results.get("export")).get("max_difference")
    if is_number(difference) and difference != 0:
        yield _Verdict("the C code, which differs from Python", False)


def _relative_half_width(entry: Mapping[str, Any]) -> float | None:
    """Half the 95 % interval over the value; None without an interval, or for a value of zero."""
    value, low, high = (entry.get(key) for key in ("value", "low", "high"))
    if not (is_number(value) and is_number(low) and is_number(high)) or value == 0:
        return None
    return 0.5 * abs((high - low) / value)


def _words(parameter: str) -> str:
    return _PARAMETERS.get(parameter, parameter)


def _list(texts: Sequence[str]) -> str:
    """ "a, b and c"."""
    return texts[0] if len(texts) == 1 else f"{', '.join(texts[:-1])} and {texts[-1]}"

"""The tables of the report as text: results in, rows out, no HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ..display.numbers import (
    NONE,
    deviation,
    digits,
    given,
    half_width,
    is_number,
    percent,
    quantity,
    with_interval,
)
from ..drivetrain import PARAMETER_UNITS
from ..plot import style
from ..recording import unit_of

#: Parts of ``results.json`` that a run may skip, and their names.
PARTS = {
    "recordings": "Recordings",
    "parameters": "Parameters",
    "fits": "Fits",
    "design": "Design",
    "observers": "Observers",
    "controllers": "Controllers",
    "export": "Export",
}
_NAMES = {
    "pi": "PI",
    "pole_placement": "Observer 1 + pole placement",
    "soft_landing": "Observer 1 + pole placement + soft landing",
    "motor_speed": "motor speed taken as estimate",
    "no_backlash": "observer without backlash",
}
_TAKEN = {
    "sample_time": "Sample time",
    "torque_limit": "Torque limit",
    "not_told": "Not identified from the recording",
    "poles": "Poles of the state feedback",
    "integral_action": "Integral action of the state feedback",
    "pi_kp": "PI: kp",
    "pi_ki": "PI: ki",
    "pi_filter_time": "PI: time constant of the set-point filter",
    "pi_speed_filter_time": "PI: time constant of the measured speed's filter",
    "step": "Test step of the set-point, from and to",
}
_SIGNALS = ("speed_load", "torque_shaft", "twist")


def words(name: object) -> str:
    """A key in words: ``observer_1`` → "Observer 1"."""
    text = _NAMES.get(str(name), str(name).replace("_", " "))
    return text[:1].upper() + text[1:]


def signal_words(signal: str) -> str:
    """A signal's name in words, with a capital: ``speed_load`` → "Load speed"."""
    return words(style.words(signal))


def skip_reason(part: Any) -> str | None:
    """The reason if a part was skipped, otherwise None."""
    return str(part["skipped"]) if isinstance(part, Mapping) and "skipped" in part else None


def mapping(part: Any) -> Mapping[str, Any]:
    """A part of the results, empty if it is missing or was skipped."""
    return part if isinstance(part, Mapping) and "skipped" not in part else {}


def skipped(results: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Name and reason of each skipped part, and of skipped entries inside parts."""
    found: list[tuple[str, str]] = []

    def search(name: str, part: Any, depth: int) -> None:
        reason = skip_reason(part)
        if reason is not None:
            found.append((name, reason))
        elif isinstance(part, Mapping) and depth:
            for key, value in part.items():
                if key == "baselines":
                    continue  # the observers say what was not recorded
                part_of = signal_words(key) if unit_of(str(key)) else words(key)
                search(f"{name}: {part_of}", value, depth - 1)

    for key, value in results.items():
        if key != "truth":  # only the virtual rig has one: its absence is no loss
            search(PARTS.get(key, words(key)), value, 3)
    return found


def parts(results: Mapping[str, Any]) -> dict[str, list[dict[str, Any]]]:
    """Rows of every table by part; an empty list where there is nothing to show."""
    return {
        "recordings": _recordings(mapping(results.get("recordings"))),
        "parameters": parameters(results),
        "fits": list(_fits(mapping(results.get("fits")))),
        "observers": list(_observers(mapping(results.get("observers")))),
        "design": list(_design(mapping(results.get("design")))),
        "controllers": _controllers(mapping(results.get("controllers")), mapping(results.get("design"))),
    }


def _recordings(recordings: Mapping[str, Any]) -> list[dict[str, Any]]:
    return [
        {
            "name": words(name),
            "file": entry.get("file") or NONE,
            "use": entry.get("use") or NONE,
            "origin": entry.get("origin") or "measured",
            "samples": f"{entry['samples']:,}".replace(",", " ") if is_number(entry.get("samples")) else NONE,
            "duration": quantity(entry.get("duration"), "s"),
            "sample_time": quantity(entry.get("sample_time"), "s"),
            "signals": ", ".join(style.words(str(s)) for s in entry.get("signals") or ()) or NONE,
        }
        for name, entry in recordings.items()
        if isinstance(entry, Mapping) and "skipped" not in entry
    ]


def parameters(results: Mapping[str, Any]) -> list[dict[str, Any]]:
    """One row for each parameter, the known ones in their usual order first."""
    found = {n: e for n, e in mapping(results.get("parameters")).items() if skip_reason(e) is None}
    truth = mapping(mapping(results.get("truth")).get("parameters"))
    order = [n for n in PARAMETER_UNITS if n in found] + [n for n in found if n not in PARAMETER_UNITS]
    return [_parameter(name, mapping(found[name]), truth.get(name)) for name in order]


def _parameter(name: str, entry: Mapping[str, Any], true: Any) -> dict[str, Any]:
    value, low, high = (entry.get(key) for key in ("value", "low", "high"))
    unit = entry.get("unit") or PARAMETER_UNITS.get(name, "")
    shown, bounds = with_interval(value, low, high, unit)
    known = is_number(value)
    return {
        "name": words(name),
        "value": shown if known else "not excited",
        "known": known,
        "interval": bounds,
        "half": half_width(value, low, high).removeprefix("±\u00a0"),
        "source": entry.get("source") or ("identified" if known else "not excited"),
        "truth": given(true, unit),
        "deviation": deviation(value, true, low, high),
        "inside": _inside(true, low, high),
    }


def _inside(true: Any, low: Any, high: Any) -> str:
    if not (is_number(true) and is_number(low) and is_number(high)):
        return NONE
    return "inside" if low <= true <= high else "outside"


def _fits(fits: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for name, entry in fits.items():
        for key, value in mapping(entry).items():
            yield {"name": words(name), "quantity": words(key), **_fit_value(value)}


def _fit_value(value: Any) -> dict[str, str]:
    if isinstance(value, Mapping):
        unit = str(value.get("unit") or "")
        shown, bounds = with_interval(value.get("value"), value.get("low"), value.get("high"), unit)
        return {"value": skip_reason(value) or shown, "interval": bounds}
    if isinstance(value, (list, tuple)):
        return {"value": ", ".join(digits(v) if is_number(v) else str(v) for v in value), "interval": NONE}
    if is_number(value):
        return {"value": str(value) if isinstance(value, int) else digits(value), "interval": NONE}
    return {"value": NONE if value is None else str(value), "interval": NONE}


def _observers(observers: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Rows grouped by signal: every observer, then the naive estimates for comparison."""
    baselines = mapping(observers.get("baselines"))
    entries = [(n, e, False) for n, e in observers.items() if n != "baselines"]
    entries += [(n, e, True) for n, e in baselines.items()]
    signals = [s for s in _SIGNALS if any(s in mapping(e) for _, e, _ in entries)]
    signals += sorted(
        {s for _, e, _ in entries for s, v in mapping(e).items() if isinstance(v, Mapping)} - set(signals)
    )
    for signal in signals:
        for name, entry, naive in entries:
            figures = mapping(mapping(entry).get(signal))
            if figures:
                yield {
                    "signal": signal_words(signal),
                    "name": words(name),
                    "naive": naive,
                    **_errors(figures, signal),
                }


def error_of(results: Mapping[str, Any], group: str, signal: str) -> float | None:
    """RMSE as a fraction of the range, of an observer or of a naive estimate; None where there is none."""
    observers = mapping(results.get("observers"))
    entry = mapping(observers.get(group) or mapping(observers.get("baselines")).get(group))
    return share_of_range(mapping(entry.get(signal)))


def best_naive(results: Mapping[str, Any], signal: str) -> tuple[str, float] | None:
    """The best of all naive estimates of a signal, in words, and its RMSE as a fraction of the range."""
    names = mapping(mapping(results.get("observers")).get("baselines"))
    errors = [(error, str(name)) for name in names if (error := error_of(results, name, signal)) is not None]
    if not errors:
        return None
    error, name = min(errors)
    return _NAMES.get(name, name.replace("_", " ")), error


def overshoot_of(results: Mapping[str, Any], controller: str) -> float | None:
    """Overshoot of a controller in per cent of the step; None where there is none."""
    value = mapping(mapping(results.get("controllers")).get(controller)).get("overshoot")
    return float(value) if is_number(value) else None


def peak_torque_of(results: Mapping[str, Any], controller: str) -> float | None:
    """Largest torque of a controller, Nm; None where there is none."""
    value = mapping(mapping(results.get("controllers")).get(controller)).get("peak_torque")
    return float(value) if is_number(value) else None


def share_of_range(figures: Mapping[str, Any]) -> float | None:
    """RMSE as a fraction of the range of one estimated signal."""
    error, span = figures.get("rmse"), figures.get("range")
    return error / span if is_number(error) and is_number(span) and span else None


def _errors(figures: Mapping[str, Any], signal: str) -> dict[str, str]:
    unit = unit_of(signal)
    span = figures.get("range")
    return {
        "rmse": quantity(figures.get("rmse"), unit),
        "share": percent(share_of_range(figures)),
        "max": quantity(figures.get("max"), unit),
        "lag": quantity(figures.get("lag"), "s", 2),
        "range": quantity(span, unit),
    }


def _design(taken: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    """What the laws were designed with, and where it comes from."""
    for name, raw in taken.items():
        entry = mapping(raw)
        value, unit = entry.get("value"), str(entry.get("unit") or "")
        if isinstance(value, (list, tuple)):
            shown = f"{', '.join(digits(v) if is_number(v) else str(v) for v in value)} {unit}"
        else:
            shown = value if isinstance(value, str) else quantity(value, unit) if is_number(value) else "none"
        yield {
            "name": _TAKEN.get(str(name), words(name)),
            "value": shown,
            "source": str(entry.get("source") or NONE),
        }


def _pi_words(taken: Mapping[str, Any]) -> str:
    """The PI controller and where its gains come from."""
    source = mapping(taken.get("pi_kp")).get("source")
    return words("pi") if source is None else f"{words('pi')}, {source}"


def _controllers(controllers: Mapping[str, Any], taken: Mapping[str, Any]) -> list[dict[str, Any]]:
    rows = []
    for name, raw in controllers.items():
        entry = mapping(raw)
        if not entry:
            continue
        overshoot = entry.get("overshoot")
        rows.append(
            {
                "name": _pi_words(taken) if name == "pi" else words(name),
                "overshoot": percent(overshoot / 100.0) if is_number(overshoot) else NONE,
                "rise_time": quantity(entry.get("rise_time"), "s"),
                "settling_time": quantity(entry.get("settling_time"), "s")
                if is_number(entry.get("settling_time"))
                else "does not settle within 2 %",
                "peak_torque": quantity(entry.get("peak_torque"), "Nm"),
                "steady_error": percent(entry.get("steady_error")),
                "impact": quantity(entry.get("impact_speed"), "rad/s"),
            }
        )
    return rows

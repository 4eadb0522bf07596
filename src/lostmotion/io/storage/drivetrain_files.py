"""drivetrain.toml: a drivetrain as readable text with units; the round trip is exact."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...argument_checks import checks_arguments
from ...drivetrain import Actuator, Drivetrain, Friction, Shaft
from ...errors import InvalidInput, within
from ...plain_data import entries, mapping, number, numbers, shown, text
from ..spelling import suggestion
from .json_files import SCHEMA_VERSION, unwrapped
from .toml_files import read_toml
from .whole_files import write_bytes

#: Half a file can be valid TOML of another drivetrain: this line is the last one of a whole file.
_END = "# end"
_HEAD = (
    f"# A chain of inertias joined by shafts, motor first, load last. SI units. The last line is {_END!r}."
)


#: What a file is expected to be, and the remedy where it is another, for ``read_toml``.
EXPECTED = ("a drivetrain as TOML", "A run writes one, drivetrain.toml, into its output folder.")


@checks_arguments
def save_drivetrain(drivetrain: Drivetrain, path: str | Path) -> None:
    """Write a drivetrain as readable TOML with units; ``load_drivetrain`` gives an equal one."""
    lines = [
        _HEAD,
        'kind = "drivetrain"',
        f"schema_version = {SCHEMA_VERSION}",
        *([_entry("locked", drivetrain.locked, "this end is held")] if drivetrain.locked else []),
        "",
        "[actuator]",
        *_entries(drivetrain.actuator, _ACTUATOR_UNITS),
    ]
    count = len(drivetrain.inertias)
    for i, (inertia, friction) in enumerate(zip(drivetrain.inertias, drivetrain.frictions, strict=True)):
        lines += ["", f"[[inertia]]  # {i + 1} of {count}" + (": motor" if i == 0 else "")]
        lines += [_entry("inertia", inertia, "kg m2"), *_entries(friction, _FRICTION_UNITS)]
    for i, shaft in enumerate(drivetrain.shafts):
        lines += ["", f"[[shaft]]  # between inertia {i + 1} and {i + 2}", *_entries(shaft, _SHAFT_UNITS)]
    write_bytes(path, ("\n".join([*lines, "", _END]) + "\n").encode())


@checks_arguments
def load_drivetrain(path: str | Path) -> Drivetrain:
    """The drivetrain in a TOML that ``save_drivetrain``, or a user in its form, wrote.

    Raises
    ------
    InvalidInput
        If the file cannot be read, its last line is missing, a key is missing or unknown, or a value is of the wrong
        type or out of range.
    """
    return drivetrain_in(*read_toml(Path(path), *EXPECTED), str(path))


def drivetrain_in(content: dict[str, Any], source: str, where: str) -> Drivetrain:
    """The drivetrain in what ``read_toml`` gives."""
    content = unwrapped(content, "drivetrain", where)
    if not source.rstrip().endswith(f"\n{_END}"):
        raise InvalidInput(
            where,
            f"no last line {_END!r}",
            "a whole drivetrain: half of one may be another one",
            f"Copy or write it again. If you wrote it by hand and it is whole, add the line {_END!r}.",
        )
    with within(where):
        return _drivetrain(content)


def _drivetrain(content: dict[str, Any]) -> Drivetrain:
    _known(content, ("actuator", "inertia", "locked", "shaft"), "drivetrain")
    inertias = _tables(content, "inertia", {"inertia", *_FRICTION_UNITS}, {"inertia"})
    shafts = _tables(content, "shaft", set(_SHAFT_UNITS), {"stiffness"})
    actuator = mapping("actuator", content.get("actuator", {}))
    _known(actuator, tuple(_ACTUATOR_UNITS), "actuator")
    locked = content.get("locked")
    return Drivetrain(
        tuple(number(f"inertia[{i}].inertia", entry["inertia"]) for i, entry in enumerate(inertias)),
        tuple(_shaft(entry, f"shaft[{i}]") for i, entry in enumerate(shafts)),
        tuple(_friction(entry, f"inertia[{i}]") for i, entry in enumerate(inertias)),
        Actuator(**{name: _limit(f"actuator.{name}", value) for name, value in actuator.items()}),
        locked=None if locked is None else text("locked", locked),
    )


def _shaft(entry: dict[str, Any], where: str) -> Shaft:
    values: dict[str, Any] = {
        name: (text if name == "contact" else number)(f"{where}.{name}", value)
        for name, value in entry.items()
    }
    with within(where):
        return Shaft(**values)


def _friction(entry: dict[str, Any], where: str) -> Friction:
    values: dict[str, Any] = {name: value for name, value in entry.items() if name != "inertia"}
    for name, value in values.items():
        place = f"{where}.{name}"
        if name == "stribeck":
            points = numbers(place, value, (len(entries(place, value)), 2))
            values[name] = tuple(map(tuple, points.tolist()))
        elif name == "coulomb" and isinstance(value, list):
            values[name] = tuple(numbers(place, value, (2,)).tolist())
        else:
            values[name] = number(place, value)
    with within(where):
        return Friction(**values)


def _limit(where: str, value: object) -> float:
    """A number, which may be inf for none."""
    return math.inf if value == math.inf else number(where, value)


_ACTUATOR_UNITS = {"lag": "s, first-order torque lag", "torque_limit": "Nm", "rate_limit": "Nm/s"}
_FRICTION_UNITS = {
    "coulomb": "Nm, or [at positive, at negative] speed",
    "viscous": "Nm s/rad",
    "breakaway": "Nm",
    "stribeck": "[[rad/s, Nm], ...] above the Coulomb level",
}
_SHAFT_UNITS = {
    "stiffness": "Nm/rad",
    "damping": "Nm s/rad",
    "backlash": "rad, total free angle",
    "contact": "torque law",
}


def _entries(thing: object, units: Mapping[str, str]) -> list[str]:
    values = {name: getattr(thing, name) for name in units}
    return [
        _entry(name, value, units[name])
        for name, value in values.items()
        if value is not None and value != ()
    ]


def _entry(name: str, value: Any, unit: str) -> str:
    return f"{f'{name} = {_toml(value)}':<34} # {unit}"


def _toml(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(float(value))


def _tables(content: dict[str, Any], name: str, known: set[str], needed: set[str]) -> list[dict[str, Any]]:
    tables = content.get(name, [])
    if not isinstance(tables, list) or not all(isinstance(entry, dict) for entry in tables):
        raise InvalidInput(name, shown(tables), f"[[{name}]] for each", "Double the brackets.")
    for i, entry in enumerate(tables):
        _known(entry, sorted(known), f"{name}[{i}]")
        if missing := sorted(needed - set(entry)):
            raise InvalidInput(f"{name}[{i}]", f"no {missing[0]!r}", "this key", "Add it.")
    return tables


def _known(table: Mapping[str, Any], known: tuple[str, ...] | list[str], where: str) -> None:
    for key in table:
        if key not in known:
            raise InvalidInput(
                where, f"unknown key {shown(key)}", "one of " + ", ".join(known), suggestion(key, known)
            )

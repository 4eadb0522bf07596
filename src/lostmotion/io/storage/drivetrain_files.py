"""drivetrain.toml: a drivetrain as readable text with units; the round trip is exact."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ...drivetrain import Actuator, Drivetrain, Friction, Shaft
from ...errors import InvalidInput
from ..spelling import suggestion
from .laws_and_recordings import SCHEMA_VERSION, unwrapped
from .toml_files import read_toml
from .whole_files import write_bytes

#: Half a file can be valid TOML of another drivetrain: the first line says how the last one reads.
_END = "# end"
_HEAD = (
    f"# A chain of inertias joined by shafts, motor first, load last. SI units. The last line is {_END!r}."
)


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
    write_bytes(Path(path), ("\n".join([*lines, "", _END]) + "\n").encode())


def load_drivetrain(path: str | Path) -> Drivetrain:
    """The drivetrain in a TOML that ``save_drivetrain``, or a user in its form, wrote.

    Raises
    ------
    InvalidInput
        If the file cannot be read, a key is missing or unknown, or a value is out of range.
    """
    where = str(path)
    content, text = read_toml(Path(path), "a drivetrain as TOML")
    if _HEAD in text and _END not in text.splitlines():
        raise InvalidInput(
            where,
            f"no line {_END!r}, which its first line speaks of",
            "a whole drivetrain: this one is cut off",
            "Copy or write it again. If you took the line out yourself, put it back at the end.",
        )
    content = unwrapped(content, "drivetrain", where)
    _known(content, ("actuator", "inertia", "locked", "shaft"), where)
    inertias = _tables(content, "inertia", {"inertia", *_FRICTION_UNITS}, {"inertia"}, where)
    shafts = _tables(content, "shaft", set(_SHAFT_UNITS), {"stiffness"}, where)
    actuator = content.get("actuator", {})
    _known(actuator, tuple(_ACTUATOR_UNITS), f"{where}, actuator")
    try:
        return Drivetrain(
            tuple(entry.pop("inertia") for entry in inertias),
            tuple(Shaft(**entry) for entry in shafts),
            tuple(Friction(**entry) for entry in inertias),
            Actuator(**actuator),
            locked=content.get("locked"),
        )
    except (TypeError, ValueError) as error:
        if isinstance(error, InvalidInput):
            p = error.problem
            raise InvalidInput(f"{where}, {p.where}", p.got, p.expected, p.remedy) from None
        raise InvalidInput(where, f"a value of the wrong type ({error})", "numbers", "Correct it.") from None


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
    text = f"{name} = {_toml(value)}"
    return f"{text:<34} # {unit}"


def _toml(value: Any) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(float(value))


def _tables(
    content: dict[str, Any], name: str, known: set[str], needed: set[str], where: str
) -> list[dict[str, Any]]:
    tables = content.get(name, [])
    if not isinstance(tables, list) or not all(isinstance(entry, dict) for entry in tables):
        raise InvalidInput(f"{where}, {name}", "one table", f"[[{name}]] for each", "Double the brackets.")
    for i, entry in enumerate(tables):
        _known(entry, sorted(known), f"{where}, {name}[{i}]")
        if missing := sorted(needed - set(entry)):
            raise InvalidInput(f"{where}, {name}[{i}]", f"no {missing[0]!r}", "this key", "Add it.")
    return [dict(entry) for entry in tables]


def _known(table: Mapping[str, Any], known: tuple[str, ...] | list[str], where: str) -> None:
    for key in table:
        if key not in known:
            raise InvalidInput(
                where, f"unknown key {key!r}", "one of " + ", ".join(known), suggestion(key, known)
            )

"""Single values of the TOML: from what stands there to SI, or the problem with it; and their JSON schema."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from ...drivetrain import PARAMETER_UNITS
from ...errors import InvalidInput, Problem
from ...plain_data import number as finite_number
from ...plain_data import shown
from ...recording import SIGNAL_UNITS
from ..spelling import suggestion
from ..tables.channels import Channel
from ..tables.units import parse_quantity

#: Smallest and largest plausible start value, in the unit of ``PARAMETER_UNITS``; zero is judged apart. Option:
#: far beyond watch gears at the one end and wind turbines at the other.
PLAUSIBLE: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "inertia_motor": (1e-12, 1e10),
        "inertia_load": (1e-12, 1e10),
        "stiffness": (1e-6, 1e12),
        "damping": (1e-12, 1e9),
        "backlash": (1e-9, 10.0),
        "coulomb": (1e-12, 1e9),
        "viscous": (1e-12, 1e9),
        "coulomb_motor": (1e-12, 1e9),
        "viscous_motor": (1e-12, 1e9),
        "lag": (1e-9, 10.0),
    }
)
#: Parameters that identification finds: friction of the motor keeps its nameplate value.
IDENTIFIED = tuple(name for name in PARAMETER_UNITS if not name.endswith("_motor") or name == "inertia_motor")
#: The fastest pole, 1/s: a law at 1 MHz cannot have a faster one (option).
FASTEST_POLE = 1e6
#: Largest gain of a controller, SI (option: as the largest plausible stiffness).
LARGEST_GAIN = 1e12


@dataclass(frozen=True)
class Key:
    """How the value of a key is read, and what an editor knows about it before that.

    Parameters
    ----------
    convert : callable
        From what stands in the TOML to SI; raises ``InvalidInput``.
    shape : mapping
        JSON schema of what stands in the TOML: looser than ``convert``, never stricter.
    """

    convert: Callable[[object], object]
    shape: Mapping[str, Any]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.convert, handler(source))

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return dict(self.shape)


def _quantity(**number: Any) -> dict[str, Any]:
    """A number in SI units, or text with a unit."""
    return {"anyOf": [{"type": "number", **number}, {"type": "string"}]}


def positive(dimension: str, meaning: str, low: float, high: float) -> Key:
    """A number above zero of that unit, between the plausible bounds."""

    def convert(value: object) -> float:
        number = parse_quantity(value, dimension)
        if not low <= number <= high:
            remedy = "Check the sign." if number <= 0.0 else "Check the unit and the power of ten."
            expected = f"a positive number, {low:g} to {high:g} {dimension}"
            raise InvalidInput("", shown(value), expected, remedy)
        return number

    return Key(convert, {**_quantity(exclusiveMinimum=0), "description": f"{dimension}, {meaning}"})


def parameter(name: str, meaning: str, *, positive: bool = False) -> Key:
    """A nameplate value within its plausible bounds."""
    low, high = PLAUSIBLE[name]
    unit = PARAMETER_UNITS[name]

    def convert(value: object) -> float:
        number = parse_quantity(value, unit)
        if not (low <= number <= high or (number == 0.0 and not positive)):
            zero = "" if positive else "zero, or "
            remedy = (
                "Check the sign."
                if number < 0.0
                else f"Check the unit and the power of ten: it is in {unit}."
            )
            raise InvalidInput("", shown(value), f"{zero}{low:g} to {high:g} {unit}", remedy)
        return number

    shapes = _quantity(minimum=low, maximum=high)["anyOf"] + ([] if positive else [{"const": 0}])
    return Key(convert, {"anyOf": shapes, "description": f"{unit}, {meaning}"})


def _window(value: object) -> tuple[float, float]:
    """Start and stop, s."""
    if not isinstance(value, list | tuple) or len(value) != 2:
        count = f", a list of {len(value)}" if isinstance(value, list | tuple) else ""
        raise InvalidInput(
            "", f"{shown(value)}{count}", "[start, stop], s", "Give both: window = [2.0, 9.0]."
        )
    start, stop = (parse_quantity(edge, "s") for edge in value)
    if not start < stop:
        remedy = "Swap them." if stop < start else "Give a later stop, or leave window out."
        raise InvalidInput("", f"[{start}, {stop}]", "[start, stop] with start < stop, s", remedy)
    return start, stop


def _gain(unit: str, zero: bool = True) -> Callable[[object], float]:
    """How a gain of the PI controller is read."""

    def convert(value: object) -> float:
        number = finite_number("", value)
        if number < 0.0:
            raise InvalidInput(
                "", shown(value), f"{'zero or ' if zero else ''}a positive number in {unit}",
                "A negative gain drives the speed away from its set-point; if torque and speed have opposite signs, "
                "set sign = -1 in their channels.",
            )  # fmt: skip
        if number > LARGEST_GAIN:
            raise InvalidInput(
                "", shown(value), f"at most {LARGEST_GAIN:g} {unit}", "Check the power of ten."
            )
        if number == 0.0 and not zero:
            raise InvalidInput(
                "",
                shown(value),
                f"a positive number in {unit}",
                "Leave kp and ki out for the package's own gains.",
            )
        return number

    return convert


def _poles(value: object) -> tuple[float, ...]:
    """Three poles: as many as a two-mass drivetrain has states."""
    example = "[-400, -400, -400]"
    expected = f"three numbers in 1/s from {-FASTEST_POLE:g} to below 0, such as {example}"
    if not isinstance(value, list | tuple):
        raise InvalidInput("", f"{shown(value)}, which is no list", expected, f"Write poles = {example}.")
    if len(value) != 3:
        raise InvalidInput(
            "",
            f"{shown(value)}, {len(value)} of them",
            expected,
            "A two-mass drivetrain has three states: give one pole for each.",
        )
    try:
        numbers = tuple(finite_number("", pole) for pole in value)
    except InvalidInput as error:
        raise InvalidInput("", error.problem.got, expected, f"Write poles = {example}.") from None
    if max(numbers) >= 0.0:
        raise InvalidInput("", shown(value), expected, "A stable pole lies left of zero: check the signs.")
    if min(numbers) < -FASTEST_POLE:
        raise InvalidInput("", shown(value), expected, "No drive is so fast: check the power of ten.")
    return numbers


def _fixed(value: object) -> tuple[str, ...]:
    """Names of parameters that are not identified."""
    if not isinstance(value, list | tuple):
        raise InvalidInput(
            "", shown(value), 'a list of parameters, such as ["lag"]', 'Write fixed = ["lag"].'
        )
    for name in value:
        if name not in IDENTIFIED:
            raise InvalidInput(
                "",
                f"unknown parameter {shown(name)}",
                ", ".join(IDENTIFIED),
                suggestion(str(name), IDENTIFIED),
            )
    if set(value) >= set(IDENTIFIED):
        raise InvalidInput("", "every parameter", "at least one to identify", "Take one out.")
    return tuple(value)


def tables(value: object) -> object:
    expected = "[[recording]], once for each file"
    if isinstance(value, dict):
        raise InvalidInput("", "a table [recording]", expected, "Double the brackets.")
    if value == []:
        raise InvalidInput("", "none", "at least one [[recording]]", "Add one.")
    if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
        raise InvalidInput(
            "", shown(value), expected, 'Write [[recording]] in a line of its own and file = "…" below it.'
        )
    return value


def _channels(value: object) -> dict[str, Channel]:
    """Channels by signal name; a name that no stage knows is an error here, where it is a slip of the pen."""
    if not isinstance(value, dict):
        raise InvalidInput(
            "", shown(value), "channels.NAME = { column = ... }", "Give one entry for each signal."
        )
    problems: list[Problem] = []
    found: dict[str, Channel] = {}
    for name, spec in value.items():
        try:
            if name not in SIGNAL_UNITS:
                raise InvalidInput(
                    name,
                    f"unknown signal {shown(name)}",
                    ", ".join(SIGNAL_UNITS),
                    suggestion(name, SIGNAL_UNITS),
                )
            found[name] = Channel.of(spec, name)
        except InvalidInput as error:
            problems.append(error.problem)
    if problems:
        raise SeveralProblems(problems)
    return found


class SeveralProblems(ValueError):
    """More than one problem under one key; each ``where`` is the rest of the key."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems
        super().__init__("; ".join(map(str, problems)))


def _time(value: object) -> object:
    if isinstance(value, dict) and "sample_time" in value:
        if set(value) != {"sample_time"}:
            raise InvalidInput(
                "", f"keys {', '.join(map(shown, value))}", "sample_time alone, or a column", "Leave one out."
            )
        step = parse_quantity(value["sample_time"], "s")
        if step <= 0.0:
            raise InvalidInput("", shown(value["sample_time"]), "more than 0 s", "Check the sign.")
        return {"sample_time": step}
    return Channel.of(value, "")


def _resample(value: object) -> float | bool:
    if isinstance(value, bool):
        return value
    step = parse_quantity(value, "s")
    if step <= 0.0:
        raise InvalidInput("", shown(value), 'true, or a sample time such as "0.1 ms"', "Check the sign.")
    return step


_COLUMN = [{"type": "string"}, {"type": "integer"}]
_CHANNEL_KEYS = {
    "column": {"anyOf": _COLUMN, "description": "header name, number from 0, or path in a .mat file"},
    "unit": {"type": "string", "description": "of the scaled number; default: the one in the file, else SI"},
    "scale": {"type": "number", "description": "factor"},
    "sign": {"enum": [1, -1]},
    "offset": {"type": "number", "description": "added after the scale"},
    "counts_per_rev": {"type": "number", "description": "for the units counts and counts/s"},
}
_CHANNEL: dict[str, Any] = {
    "anyOf": [
        *_COLUMN,
        {
            "type": "object",
            "properties": {field.name: _CHANNEL_KEYS[field.name] for field in fields(Channel)},
            "required": ["column"],
            "additionalProperties": False,
        },
    ]
}
_SAMPLE_TIME = {
    "type": "object",
    "properties": {"sample_time": _quantity(exclusiveMinimum=0)},
    "required": ["sample_time"],
    "additionalProperties": False,
}

WINDOW = Key(_window, {"type": "array", "items": _quantity(), "minItems": 2, "maxItems": 2})
GAIN = Key(_gain("Nm/rad"), {"type": "number", "minimum": 0})
PROPORTIONAL_GAIN = Key(_gain("Nm s/rad", zero=False), {"type": "number", "exclusiveMinimum": 0})
POLES = Key(
    _poles,
    {"type": "array", "items": {"type": "number", "exclusiveMaximum": 0}, "minItems": 3, "maxItems": 3},
)
FIXED = Key(_fixed, {"type": "array", "items": {"enum": list(IDENTIFIED)}})
CHANNELS = Key(
    _channels,
    {"type": "object", "properties": dict.fromkeys(SIGNAL_UNITS, _CHANNEL), "additionalProperties": False},
)
DELAY = Key(lambda value: parse_quantity(value, "s"), _quantity())
TIME = Key(_time, {"anyOf": [*_CHANNEL["anyOf"], _SAMPLE_TIME]})
RESAMPLE = Key(_resample, {"anyOf": [{"type": "boolean"}, *_quantity(exclusiveMinimum=0)["anyOf"]]})

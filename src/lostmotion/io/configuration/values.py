"""Single values of the TOML: from what stands there to SI, or the problem with it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from pydantic import BeforeValidator

from ...drivetrain import PARAMETER_UNITS
from ...errors import InvalidInput, Problem
from ...recording import SIGNAL_UNITS
from ..spelling import suggestion
from ..tables.channels import Channel
from ..tables.units import parse_quantity

#: Smallest and largest plausible start value, in the unit of ``PARAMETER_UNITS``; zero is judged apart. Chosen:
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


def positive(dimension: str) -> BeforeValidator:
    def convert(value: object) -> float:
        number = parse_quantity(value, dimension)
        if number <= 0.0:
            raise InvalidInput("", repr(value), "a positive number", "Check the sign.")
        return number

    return BeforeValidator(convert)


def parameter(name: str, *, positive: bool = False) -> BeforeValidator:
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
            raise InvalidInput("", repr(value), f"{zero}{low:g} to {high:g} {unit}", remedy)
        return number

    return BeforeValidator(convert)


def edge(value: object) -> float:
    return parse_quantity(value, "s")


def gain(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < float("inf"):
        raise InvalidInput("", repr(value), "zero or a positive number in SI units", "Check it.")
    return float(value)


def proportional_gain(value: object) -> float:
    if (number := gain(value)) == 0.0:
        raise InvalidInput(
            "",
            repr(value),
            "a positive number in SI units",
            "Leave kp and ki out for the package's own gains.",
        )
    return number


def poles(value: object) -> tuple[float, ...]:
    """Three poles: as many as a two-mass drivetrain has states."""
    good = isinstance(value, list | tuple) and len(value) == 3
    numbers = value if isinstance(value, list | tuple) else ()
    if not good or any(
        isinstance(p, bool) or not isinstance(p, int | float) or not -1e9 < p < 0 for p in numbers
    ):
        raise InvalidInput(
            "",
            repr(value),
            "three negative numbers in 1/s",
            "A stable pole lies left of zero: [-400, -400, -400].",
        )
    return tuple(map(float, numbers))


def tables(value: object) -> object:
    if isinstance(value, dict):
        raise InvalidInput(
            "", "a table [recording]", "[[recording]], once for each file", "Double the brackets."
        )
    if value == []:
        raise InvalidInput("", "none", "at least one [[recording]]", "Add one.")
    return value


def channels(value: object) -> dict[str, Channel]:
    """Channels by signal name; a name that no stage knows is an error here, where it is a slip of the pen."""
    if not isinstance(value, dict):
        raise InvalidInput(
            "", repr(value), "channels.NAME = { column = ... }", "Give one entry for each signal."
        )
    problems: list[Problem] = []
    found: dict[str, Channel] = {}
    for name, spec in value.items():
        try:
            if name not in SIGNAL_UNITS:
                raise InvalidInput(
                    name, f"unknown signal {name!r}", ", ".join(SIGNAL_UNITS), suggestion(name, SIGNAL_UNITS)
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


def time(value: object) -> object:
    if isinstance(value, dict) and "sample_time" in value:
        if set(value) != {"sample_time"}:
            raise InvalidInput(
                "", f"keys {', '.join(map(repr, value))}", "sample_time alone, or a column", "Leave one out."
            )
        step = parse_quantity(value["sample_time"], "s")
        if step <= 0.0:
            raise InvalidInput("", repr(value["sample_time"]), "more than 0 s", "Check the sign.")
        return {"sample_time": step}
    return Channel.of(value, "")


def resample(value: object) -> float | bool:
    if isinstance(value, bool):
        return value
    step = parse_quantity(value, "s")
    if step <= 0.0:
        raise InvalidInput("", repr(value), 'true, or a sample time such as "0.1 ms"', "Check the sign.")
    return step

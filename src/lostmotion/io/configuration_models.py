"""The TOML's shape as pydantic models; only ``configuration`` uses them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from ..drivetrain import PARAMETER_UNITS
from ..errors import InputProblems, InvalidInput, Problem
from ..recording import SIGNAL_UNITS
from .channels import Channel
from .columns import suggestion
from .configuration import DEFAULT_POLES
from .units import parse_quantity

Place = Callable[[tuple[str | int, ...]], str]

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


def _positive(dimension: str) -> BeforeValidator:
    def convert(value: object) -> float:
        number = parse_quantity(value, dimension)
        if number <= 0.0:
            raise InvalidInput("", repr(value), "a positive number", "Check the sign.")
        return number

    return BeforeValidator(convert)


def _parameter(name: str, *, positive: bool = False) -> BeforeValidator:
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


def _edge(value: object) -> float:
    return parse_quantity(value, "s")


def _gain(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < float("inf"):
        raise InvalidInput("", repr(value), "zero or a positive number in SI units", "Check it.")
    return float(value)


def _proportional_gain(value: object) -> float:
    if (gain := _gain(value)) == 0.0:
        raise InvalidInput(
            "",
            repr(value),
            "a positive number in SI units",
            "Leave kp and ki out for the package's own gains.",
        )
    return gain


def _poles(value: object) -> tuple[float, ...]:
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


def _tables(value: object) -> object:
    if isinstance(value, dict):
        raise InvalidInput(
            "", "a table [recording]", "[[recording]], once for each file", "Double the brackets."
        )
    if value == []:
        raise InvalidInput("", "none", "at least one [[recording]]", "Add one.")
    return value


def _channels(value: object) -> dict[str, Channel]:
    """Channels by signal name; a name that no stage knows is an error here, where it is a slip of the pen."""
    if not isinstance(value, dict):
        raise InvalidInput(
            "", repr(value), "channels.NAME = { column = ... }", "Give one entry for each signal."
        )
    problems: list[Problem] = []
    channels: dict[str, Channel] = {}
    for name, spec in value.items():
        try:
            if name not in SIGNAL_UNITS:
                raise InvalidInput(
                    name, f"unknown signal {name!r}", ", ".join(SIGNAL_UNITS), suggestion(name, SIGNAL_UNITS)
                )
            channels[name] = Channel.of(spec, name)
        except InvalidInput as error:
            problems.append(error.problem)
    if problems:
        raise _Several(problems)
    return channels


class _Several(ValueError):
    """More than one problem under one key; each ``where`` is the rest of the key."""

    def __init__(self, problems: list[Problem]) -> None:
        self.problems = problems
        super().__init__("; ".join(map(str, problems)))


def _time(value: object) -> object:
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


def _resample(value: object) -> float | bool:
    if isinstance(value, bool):
        return value
    step = parse_quantity(value, "s")
    if step <= 0.0:
        raise InvalidInput("", repr(value), 'true, or a sample time such as "0.1 ms"', "Check the sign.")
    return step


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class NameplateModel(_Model):
    """Start values, and what a recording cannot tell; units as in ``PARAMETER_UNITS``, bounds in ``PLAUSIBLE``."""

    inertia_motor: Annotated[float | None, _parameter("inertia_motor", positive=True)] = None
    inertia_load: Annotated[float | None, _parameter("inertia_load", positive=True)] = None
    stiffness: Annotated[float | None, _parameter("stiffness", positive=True)] = None
    damping: Annotated[float | None, _parameter("damping")] = None
    backlash: Annotated[float | None, _parameter("backlash")] = None
    coulomb: Annotated[float | None, _parameter("coulomb")] = None
    viscous: Annotated[float | None, _parameter("viscous")] = None
    coulomb_motor: Annotated[float | None, _parameter("coulomb_motor")] = None
    viscous_motor: Annotated[float | None, _parameter("viscous_motor")] = None
    lag: Annotated[float | None, _parameter("lag")] = None


class RecordingModel(_Model):
    """One recording: where it lies, what it is for, which column is what."""

    file: Annotated[str, Field(strict=True, min_length=1)]
    use: Literal["identify", "validate"] = "identify"
    time: Annotated[Any, BeforeValidator(_time)] = None
    channels: Annotated[dict[str, Channel], BeforeValidator(_channels)] = {}
    window: (
        tuple[Annotated[float, BeforeValidator(_edge)], Annotated[float, BeforeValidator(_edge)]] | None
    ) = None
    resample: Annotated[float | bool | None, BeforeValidator(_resample)] = None
    count_averaged: Annotated[bool | None, Field(strict=True)] = None

    @model_validator(mode="after")
    def _window_in_order(self) -> RecordingModel:
        if self.window is not None and not self.window[0] < self.window[1]:
            raise InvalidInput(
                "", f"window {list(self.window)}", "[start, stop] with start < stop, s", "Swap them."
            )
        return self


class LawModel(_Model):
    """What the law shall do."""

    sample_time: Annotated[float | None, _positive("s")] = None
    torque_limit: Annotated[float | None, _positive("Nm")] = None
    poles: Annotated[tuple[float, ...], BeforeValidator(_poles)] = DEFAULT_POLES
    kp: Annotated[float | None, BeforeValidator(_proportional_gain)] = None
    ki: Annotated[float | None, BeforeValidator(_gain)] = None

    @model_validator(mode="after")
    def _both_gains(self) -> LawModel:
        if (self.kp is None) != (self.ki is None):
            raise InvalidInput(
                "", f"kp {self.kp}, ki {self.ki}", "both gains of the PI controller or none", "Add it."
            )
        return self


class RunModel(_Model):
    """How to run."""

    seed: Annotated[int, Field(strict=True, ge=0)] = 1


class ConfigurationModel(_Model):
    """The whole TOML."""

    nameplate: NameplateModel = NameplateModel()
    recording: Annotated[tuple[RecordingModel, ...], BeforeValidator(_tables)]
    law: LawModel = LawModel()
    run: RunModel = RunModel()


def validated(
    content: dict[str, Any], place: Place
) -> tuple[dict[str, float], list[dict[str, Any]], dict[str, Any], dict[str, Any]]:
    """Nameplate, recordings, law and run of a TOML as plain values in SI.

    Raises
    ------
    InputProblems
        All problems together; ``place`` turns a key path into what the user is shown.
    """
    try:
        model = ConfigurationModel.model_validate(content)
    except ValidationError as error:
        raise InputProblems([p for e in error.errors() for p in _problems(dict(e), place)]) from None
    nameplate = {name: v for name in PARAMETER_UNITS if (v := getattr(model.nameplate, name)) is not None}
    recordings = [{name: getattr(r, name) for name in type(r).model_fields} for r in model.recording]
    law = {name: getattr(model.law, name) for name in LawModel.model_fields}
    return nameplate, recordings, law, {"seed": model.run.seed}


def _problems(error: dict[str, Any], place: Place) -> list[Problem]:
    """One of pydantic's errors in the package's form."""
    location: tuple[str | int, ...] = error["loc"]
    where = place(location)
    cause = error.get("ctx", {}).get("error")
    if isinstance(cause, _Several):
        return [
            Problem("error", place((*location, p.where)), p.got, p.expected, p.remedy) for p in cause.problems
        ]
    if isinstance(cause, InvalidInput):
        p = cause.problem
        return [Problem("error", where, p.got, p.expected, p.remedy)]
    if error["type"] == "extra_forbidden":
        known = _known_keys(location[:-1])
        remedy = suggestion(str(location[-1]), known)
        return [
            Problem("error", where, f"unknown key {location[-1]!r}", "one of " + ", ".join(known), remedy)
        ]
    if error["type"] == "missing":
        remedy = "Add a [[recording]]." if location == ("recording",) else "Add it."
        return [Problem("error", where, "nothing", "this key", remedy)]
    return [
        Problem(
            "error",
            where,
            repr(error["input"]),
            error["msg"].removeprefix("Input should be "),
            "Correct the value.",
        )
    ]


def _known_keys(location: tuple[str | int, ...]) -> list[str]:
    models: dict[str, type[_Model]] = {
        "nameplate": NameplateModel,
        "recording": RecordingModel,
        "law": LawModel,
        "run": RunModel,
    }
    model = models[str(location[0])] if location else ConfigurationModel
    return list(model.model_fields)

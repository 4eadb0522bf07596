"""The TOML's shape as pydantic models; only ``configuration`` uses them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from ...drivetrain import PARAMETER_UNITS
from ...errors import InputProblems, InvalidInput, Problem
from ...plain_data import shown
from ..spelling import suggestion
from ..tables.channels import Channel
from . import methods
from . import values as value

Place = Callable[[tuple[str | int, ...]], str]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, arbitrary_types_allowed=True)


class NameplateModel(_Model):
    """Start values of the identification, and what a recording cannot tell."""

    inertia_motor: Annotated[
        float | None,
        value.parameter("inertia_motor", "everything on the motor's side of the gap", positive=True),
    ] = None
    inertia_load: Annotated[
        float | None, value.parameter("inertia_load", "everything on the load's side", positive=True)
    ] = None
    stiffness: Annotated[
        float | None, value.parameter("stiffness", "of the shaft between them", positive=True)
    ] = None
    damping: Annotated[float | None, value.parameter("damping", "of that shaft")] = None
    backlash: Annotated[float | None, value.parameter("backlash", "the total free angle")] = None
    coulomb: Annotated[float | None, value.parameter("coulomb", "Coulomb friction of the load")] = None
    viscous: Annotated[float | None, value.parameter("viscous", "viscous friction of the load")] = None
    coulomb_motor: Annotated[
        float | None, value.parameter("coulomb_motor", "Coulomb friction of the motor")
    ] = None
    viscous_motor: Annotated[
        float | None, value.parameter("viscous_motor", "viscous friction of the motor")
    ] = None
    lag: Annotated[float | None, value.parameter("lag", "first-order lag behind the set-point")] = None


class FurtherModel(_Model):
    """A further file of a recording, with a clock of its own."""

    file: Annotated[str, Field(strict=True, min_length=1, description="relative to the TOML, or absolute")]
    time: Annotated[Any, value.TIME, Field(description="as in the recording")] = None
    channels: Annotated[dict[str, Channel], value.CHANNELS, Field(description="as in the recording")] = {}
    by: Annotated[
        str | None, Field(strict=True, description="signal that both files have, by which they are aligned")
    ] = None
    delay: Annotated[
        float | None, value.DELAY, Field(description="by how much this file's clock is ahead, s")
    ] = None


class RecordingModel(_Model):
    """One recording: where it lies, what it is for, which column is what."""

    file: Annotated[str, Field(strict=True, min_length=1, description="relative to the TOML, or absolute")]
    use: Annotated[
        str,
        value.Key(methods.use, {"enum": list(methods.USES)}),
        Field(description="to find the parameters, to judge the observers, or the test that was recorded"),
    ] = "identify"
    options: Annotated[
        dict[str, Any], Field(description="of the test: arguments of the function that has its name")
    ] = {}
    time: Annotated[
        Any, value.TIME, Field(description='column of the time, or { sample_time = "0.1 ms" }')
    ] = None
    channels: Annotated[
        dict[str, Channel],
        value.CHANNELS,
        Field(description="signal = column, or a table with unit and scale"),
    ] = {}
    window: Annotated[
        tuple[float, float] | None,
        value.WINDOW,
        Field(description="[start, stop], s: only this part is read"),
    ] = None
    resample: Annotated[
        float | bool | None,
        value.RESAMPLE,
        Field(description="sample time of a new raster, or true: the median step"),
    ] = None
    speed_from_counts: Annotated[
        bool | None, Field(strict=True, description="whether the motor speed is a mean over the last sample")
    ] = None

    further: Annotated[
        tuple[FurtherModel, ...],
        Field(description="further files with more signals, on the raster of this one"),
    ] = ()

    @model_validator(mode="after")
    def _known_options(self) -> RecordingModel:
        methods.options(self.use, self.options)
        return self


class IdentifyModel(_Model):
    """How to identify."""

    fixed: Annotated[
        tuple[str, ...],
        value.FIXED,
        Field(description="parameters that keep their nameplate value"),
    ] = ()
    load_torque: Annotated[
        bool, Field(strict=True, description="whether an unknown, slowly changing torque acts on the load")
    ] = False
    measured: Annotated[
        tuple[str, ...],
        value.Key(methods.measured, {"type": "array", "items": {"enum": list(methods.MEASURED)}}),
        Field(description="signals beside the motor speed that are used"),
    ] = ()


class LawModel(_Model):
    """What the law shall do."""

    sample_time: Annotated[
        float | None, value.positive("s", "default: that of the recording", 1e-7, 10.0)
    ] = None
    torque_limit: Annotated[
        float | None, value.positive("Nm", "default: the largest recorded motor torque", 1e-9, 1e12)
    ] = None
    poles: Annotated[
        tuple[float, ...] | None,
        value.POLES,
        Field(description="1/s, three negative numbers: of the state feedback; default: from the drive"),
    ] = None
    kp: Annotated[
        float | None,
        value.PROPORTIONAL_GAIN,
        Field(description="Nm s/rad, PI speed controller to compare with; default: symmetrical optimum"),
    ] = None
    ki: Annotated[float | None, value.GAIN, Field(description="Nm/rad, of the same controller")] = None

    @model_validator(mode="after")
    def _both_gains(self) -> LawModel:
        if (self.kp is None) != (self.ki is None):
            raise InvalidInput(
                "",
                f"{'ki' if self.kp is None else 'kp'} alone",
                "both gains of the PI controller or none",
                f"Add {'kp' if self.kp is None else 'ki = 0 for a proportional controller, or another'}, or "
                "leave both out.",
            )
        return self


class RunModel(_Model):
    """How to run."""

    seed: Annotated[
        int, Field(strict=True, ge=0, lt=2**63, description="of everything random in the run")
    ] = 1


class ConfigurationModel(_Model):
    """The whole TOML."""

    nameplate: NameplateModel = NameplateModel()
    recording: Annotated[
        tuple[RecordingModel, ...],
        BeforeValidator(value.tables),
        Field(
            json_schema_extra={"minItems": 1}
        ),  # min_length would count what has problems of its own as missing
    ]
    identify: IdentifyModel = IdentifyModel()
    law: LawModel = LawModel()
    run: RunModel = RunModel()


def validated(
    content: dict[str, Any], place: Place
) -> tuple[dict[str, float], list[dict[str, Any]], dict[str, dict[str, Any]]]:
    """Nameplate and recordings of a TOML, and its further tables by name, as plain values in SI.

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
    _check_fixed(model, place)
    tables = {
        name: {key: getattr(table, key) for key in type(table).model_fields}
        for name, table in (("identify", model.identify), ("law", model.law), ("run", model.run))
    }
    return nameplate, recordings, tables


def _check_fixed(model: ConfigurationModel, place: Place) -> None:
    """Raise ``InputProblems`` for a parameter that shall keep a value that is not given."""
    unknown = [
        Problem(
            "error",
            place(("identify", "fixed")),
            f"{name}, which has no value",
            f"a value for {name} under [nameplate]",
            f"Give {name} = ... under [nameplate], or take it out of fixed.",
        )
        for name in model.identify.fixed
        if getattr(model.nameplate, name) is None
    ]
    if unknown:
        raise InputProblems(unknown)


def _problems(error: dict[str, Any], place: Place) -> list[Problem]:
    """One of pydantic's errors in the package's form."""
    location: tuple[str | int, ...] = error["loc"]
    where = place(location)
    cause = error.get("ctx", {}).get("error")
    if isinstance(cause, value.SeveralProblems):
        return [
            Problem("error", place((*location, *p.where.split(", "))), p.got, p.expected, p.remedy)
            for p in cause.problems
        ]
    if isinstance(cause, InvalidInput):
        p = cause.problem
        return [Problem("error", where, p.got, p.expected, p.remedy)]
    if error["type"] == "extra_forbidden":
        known = _known_keys(location[:-1])
        remedy = suggestion(str(location[-1]), known)
        return [
            Problem(
                "error", where, f"unknown key {shown(location[-1])}", "one of " + ", ".join(known), remedy
            )
        ]
    if error["type"] == "missing":
        remedy = "Add a [[recording]]." if location == ("recording",) else "Add it."
        return [Problem("error", where, "nothing", "this key", remedy)]
    if error["type"] == "model_type":
        name = location[-1]
        return [
            Problem("error", where, shown(error["input"]), f"a table [{name}]", "Write its keys below it.")
        ]
    return [
        Problem(
            "error",
            where,
            shown(error["input"]),
            _EXPECTED.get(error["type"]) or error["msg"].removeprefix("Input should be "),
            "Correct the value.",
        )
    ]


#: What pydantic says of a value, in words that a user knows.
_EXPECTED = {
    "int_type": "a whole number, without quotes",
    "string_type": "a text in quotes",
    "string_too_short": "the name of a file",
    "bool_type": "true or false, without quotes",
}


def _known_keys(location: tuple[str | int, ...]) -> list[str]:
    models: dict[str, type[_Model]] = {
        "nameplate": NameplateModel,
        "recording": RecordingModel,
        "identify": IdentifyModel,
        "law": LawModel,
        "run": RunModel,
    }
    model = models[str(location[0])] if location else ConfigurationModel
    return list(model.model_fields)

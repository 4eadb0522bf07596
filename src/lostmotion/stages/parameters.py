"""Stage 2, identify: every parameter with its value, its 95 % interval and its source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..drivetrain import PARAMETER_UNITS, Drivetrain
from ..errors import InvalidInput, Problem
from ..identification import (
    Estimates,
    Identification,
    RingDown,
    ShaftStiffness,
    backlash_excited,
    identify,
    ring_down,
    shaft_stiffness,
)
from ..io.recordings.torque_and_speed import inertia_shown
from ..recording import Recording
from .material import Material
from .single_tests import SingleTest

#: Without these nothing can be designed; friction and lag may be zero.
NEEDED = ("inertia_motor", "inertia_load", "stiffness")
#: Shown although they are not known; zero is taken for the design, which then damps the shaft by itself, and suits a
#: drive with a gap as well.
SHOWN = (*NEEDED, "backlash", "damping")
#: A nameplate's value that the recording did not tell may be off by this factor (option: that within which
#: ``identify`` asks for it).
OFF = 2.0
#: Signals that identification by prediction error needs.
DRIVEN = ("torque_motor", "speed_motor")
#: Signals that the measurement of a shaft needs.
SHAFT = ("speed_motor", "speed_load", "torque_shaft")


@dataclass(frozen=True, eq=False)
class Found:
    """Results of stage 2.

    Parameters
    ----------
    table : mapping of parameter → {"value", "low", "high", "unit", "source"}
        As in ``results.json``.
    drivetrain : Drivetrain or None
        Model for the design; None where too little is known, then `missing` says what.
    identification : Identification or None
    shaft, ringing : ShaftStiffness, RingDown or None
        Results from a measured shaft torque.
    skipped : str
        Why there is no identification by prediction error.
    fits : mapping
        For the report.
    problems : tuple of Problem
    """

    table: Mapping[str, Mapping[str, Any]]
    drivetrain: Drivetrain | None
    missing: str = ""
    identification: Identification | None = None
    shaft: ShaftStiffness | None = None
    ringing: RingDown | None = None
    skipped: str = ""
    fits: Mapping[str, Any] = field(default_factory=dict)
    problems: tuple[Problem, ...] = ()

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """95 % intervals by parameter, SI."""
        return {n: (e["low"], e["high"]) for n, e in self.table.items() if e["low"] is not None}

    def with_tests(self, tests: Sequence[SingleTest]) -> Found:
        """With what tests of one thing found, among the fits."""
        fits = {**self.fits, **{test.title: test.fit() for test in tests}}
        return replace(self, fits=fits, problems=(*self.problems, *(p for t in tests for p in t.problems)))


def find_parameters(material: Material, progress: Callable[[float, str], None] | None = None) -> Found:
    """By prediction error where there is a motor torque, else from the shaft torque where there is one."""
    table = {name: _entry(name, value, "nameplate") for name, value in material.nameplate.items()}
    recording = material.identify
    if recording is None:
        return _finished(material.nameplate, table, skipped="no recording with use = 'identify'")
    reason = _reason_against(recording, material.nameplate)
    refusal: tuple[Problem, ...] = ()
    if not reason:
        try:
            found = identify(
                recording,
                start=two_mass(material.nameplate),
                fixed=material.settings.fixed,
                load_torque=material.settings.load_torque,
                measured=("speed_motor", *material.settings.measured),
                progress=progress,
            )
        except InvalidInput as error:
            reason, refusal = str(error), (replace(error.problem, severity="warning"),)
    if reason:
        made = _of_the_shaft(material, recording, table, reason)
        return replace(made, problems=(*refusal, *made.problems))
    made = _finished(
        material.nameplate,
        table | found.table(),
        found,
        fits=_prediction_fits(found),
        problems=found.problems,
    )
    reason = contradiction(made, recording)
    return replace(made, drivetrain=None, missing=reason) if reason else made


def _of_the_shaft(
    material: Material, recording: Recording, table: dict[str, dict[str, Any]], reason: str
) -> Found:
    """Without a motor torque, the stiffness still follows from the speeds at both ends and the torque of the shaft.

    ``reason``: why there is no identification by prediction error.
    """
    shaft: ShaftStiffness | None = None
    ringing: RingDown | None = None
    problems: tuple[Problem, ...] = ()
    fits: dict[str, Any] = {}
    if all(name in recording for name in SHAFT):
        shaft, ringing = shaft_stiffness(recording), ring_down(recording, seed=material.seed)
        excited = backlash_excited(recording)
        problems = (*shaft.problems, *ringing.problems, *excited.problems)
        fits = _shaft_fits(shaft, ringing)
        if excited.excited is False:
            table["backlash"] = _entry("backlash", None, "not excited")
        if material.validate is not None and all(name in material.validate for name in SHAFT):
            fits["shaft, validation recording"] = _shaft_fit(shaft_stiffness(material.validate))
        if shaft.values["stiffness"] is not None:
            table["stiffness"] = shaft.table()["stiffness"]
    made = _finished(material.nameplate, table, None, shaft, ringing, reason, fits, problems)
    if "backlash" in material.nameplate:
        return made
    # Nothing but a nameplate that does not even know the gap: no law is made of that.
    return replace(made, drivetrain=None, missing=made.missing or reason)


def two_mass(values: Mapping[str, Any]) -> Drivetrain:
    """The drivetrain of parameters by name, SI; those that may be zero may be missing."""
    return Drivetrain.two_mass(**dict(values))


def _reason_against(recording: Recording, nameplate: Mapping[str, float]) -> str:
    missing = [name for name in DRIVEN if name not in recording]
    if missing:
        return f"no {' and no '.join(missing)} in the recording"
    missing = [name for name in ("inertia_motor", "inertia_load", "stiffness") if name not in nameplate]
    return f"no start value for {', '.join(missing)}: add it to [nameplate]" if missing else ""


def _prediction_fits(found: Identification) -> dict[str, Any]:
    prediction = found.prediction
    fits: dict[str, Any] = {
        "prediction error": {
            "residual": {"value": prediction.rms, "unit": "rad/s"},
            "fit": prediction.fit,
            "iterations": prediction.iterations,
        }
    }
    fits["model"] = found.remarks()
    if prediction.joint_piece is not None:
        share, compliance = prediction.joint_piece
        fits["intermediate inertia on the shaft"] = {
            "part of the motor's inertia": share,
            "part of the shaft's compliance before it": compliance,
        }
    return fits


def _shaft_fit(shaft: ShaftStiffness) -> dict[str, Any]:
    return {
        "stiffness": _fit(shaft, "stiffness"),
        "torque late by": _fit(shaft, "torque_delay"),
    }


def _shaft_fits(shaft: ShaftStiffness, ringing: RingDown) -> dict[str, Any]:
    return {
        "shaft": _shaft_fit(shaft),
        "ring-down": {
            "frequency": _fit(ringing, "frequency"),
            "damping ratio (of the whole rig in operation)": _fit(ringing, "damping_ratio"),
        },
    }


def _fit(found: Estimates, name: str) -> dict[str, Any]:
    entry = found.table()[name]
    source = entry.pop("source")
    return {"skipped": source} if entry["value"] is None else entry


def _entry(name: str, value: float | None, source: str) -> dict[str, Any]:
    """A parameter that was not identified."""
    return {"value": value, "low": None, "high": None, "unit": PARAMETER_UNITS[name], "source": source}


def _finished(
    nameplate: Mapping[str, float],
    table: dict[str, dict[str, Any]],
    found: Identification | None = None,
    shaft: ShaftStiffness | None = None,
    ringing: RingDown | None = None,
    skipped: str = "",
    fits: Mapping[str, Any] | None = None,
    problems: tuple[Problem, ...] = (),
) -> Found:
    """The model for the design: identified values, else the user's; never the start value of something unknown."""
    for name in SHOWN:
        table.setdefault(name, _entry(name, None, "not excited"))
    ordered = {name: table[name] for name in (*PARAMETER_UNITS, "inertia_total") if name in table}
    values = {**nameplate, **{n: e["value"] for n, e in ordered.items() if e["value"] is not None}}
    missing = [name for name in NEEDED if name not in values]
    drivetrain: Drivetrain | None = None
    reason = ""
    if missing:
        keys = " and ".join(f"{name} = ..." for name in missing)
        reason = f"{', '.join(missing)} not known: give {keys} under [nameplate], or record a test that identifies it"
    elif found is None:
        drivetrain = two_mass(values)
    else:
        known = {} if "damping" in values else {"damping": 0.0}
        drivetrain = found.drivetrain.with_parameters(**known)
    return Found(ordered, drivetrain, reason, found, shaft, ringing, skipped, fits or {}, problems)


def contradiction(found: Found, recording: Recording) -> str:
    """Why no law may be made of the nameplate's inertias, which the recording did not tell; nothing if one may."""
    drivetrain, inertias = found.drivetrain, ("inertia_motor", "inertia_load")
    if drivetrain is None or any(found.table[name]["source"] != "not excited" for name in inertias):
        return ""
    shown = inertia_shown(recording)
    if shown is None or 1.0 / OFF < shown / drivetrain.inertia_total < OFF:
        return ""
    return (
        f"the recording contradicts the nameplate: it shows an inertia of {shown:.2g} instead of "
        f"{drivetrain.inertia_total:.2g} kg m2. Check sign, scale and unit in the channels of torque and speed, and "
        "inertia_motor and inertia_load under [nameplate]"
    )

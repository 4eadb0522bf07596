"""Every public function, with each of its arguments wrong in turn: the package's own error, or an answer."""

from __future__ import annotations

import importlib
import inspect
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sound_calls import Call, sound_calls

import lostmotion as lm
from lostmotion.errors import InputProblems, InvalidInput, LostMotionError, Problem

WRONG: dict[str, Any] = {
    "text": "nonsense",
    "None": None,
    "NaN": float("nan"),
    "infinity": float("inf"),
    "negative": -1.0,
    "huge": 1e300,
    "beyond floats": 10**400,
    "zero": 0,
    "bool": True,
    "complex": 1j,
    "mixed list": ["a", 1],
    "empty list": [],
    "mapping": {"a": 1},
    "bytes": b"x",
    "matrix": np.ones((3, 2)),
    "row of NaN": np.full(400, np.nan),
    "another class": object(),
}
#: What no argument takes, but these: a batch hands its torque on to each simulation, whose failure is a result, and the
#: law that a check belongs to knows its inputs.
NEVER = ("another class", "bytes")
TAKES_ANYTHING = {"simulate_batch.torque_motor", "InputCheck.input"}

#: Public rooms all of whose functions are checked here; the observers have their own test, ``test_observer_arguments``.
ROOMS = (
    "", "certificates", "controllers", "identification", "io", "rig", "signals", "simulation", "structure", "systems",
)  # fmt: skip
#: Functions that are shown elsewhere, or take what others have made.
ELSEWHERE = {
    "cramer_rao": "takes a Drive",
    "drive": "a recording of the zoo takes seconds",
    "configuration_schema": "takes nothing",
    "template": "takes nothing",
    "nominal_rig": "takes nothing",
    "finer_rig": "takes what identify has found",
    "output_folder": "tests/io/storage/test_folders.py",
    "output_error_fit": "takes a FrictionFit",
    "simulate_rigid_drive": "takes a FrictionFit",
    "two_mass_fit": "takes a FrequencyResponse",
    "read_trajectories": "takes the folder of a batch",
    "steady_state": "takes a DesignModel",
    "margin_data": "takes what margins gives",
    "margin_table": "takes what margin_data gives",
}


@pytest.fixture(scope="module")
def calls(tmp_path_factory: pytest.TempPathFactory) -> list[Call]:
    return sound_calls(tmp_path_factory.mktemp("files"))


def name_of(call: Call) -> str:
    return str(call.function.__qualname__)


def complaint(error: BaseException) -> str:
    """What is wrong with an error; nothing where it is the package's own and says all."""
    if not isinstance(error, LostMotionError):
        return f"{type(error).__name__}: {error}"
    problems = error.problems if isinstance(error, InputProblems) else (getattr(error, "problem", None),)
    for problem in problems:
        if not isinstance(problem, Problem) or not (problem.got and problem.expected and problem.remedy):
            return f"unclear: {error}"
    return ""


def test_wrong_arguments(
    calls: list[Call], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, recwarn: pytest.WarningsRecorder
) -> None:
    monkeypatch.chdir(tmp_path)
    faults = []
    for call in calls:
        for argument in call.arguments:
            for label, value in WRONG.items():
                place = f"{name_of(call)}.{argument}"
                try:
                    call.function(**{**call.arguments, argument: value})
                except Exception as error:
                    if said := complaint(error):
                        faults.append(f"{place}, {label}: {said}")
                else:
                    if label in NEVER and place not in TAKES_ANYTHING:
                        faults.append(f"{place}, {label}: is taken")
    assert not faults, f"{len(faults)}:\n" + "\n".join(faults[:40])


def test_the_argument_and_its_function_are_named(calls: list[Call]) -> None:
    for call in calls:
        for argument in call.arguments:
            place = f"{name_of(call)}.{argument}"
            if place not in TAKES_ANYTHING | {"parse_quantity.value"}:  # that one is named by its "where"
                with pytest.raises(LostMotionError) as caught:
                    call.function(**{**call.arguments, argument: object()})
                assert argument.split("_")[0] in str(caught.value), place


def test_every_public_function_is_here(calls: list[Call]) -> None:
    known = {name_of(call) for call in calls} | set(ELSEWHERE)
    missing = []
    for room in ROOMS:
        module = importlib.import_module(f"lostmotion.{room}".rstrip("."))
        for name in getattr(module, "__all__", dir(module)):
            one = getattr(module, name)
            if inspect.isfunction(one) and name[0] != "_" and one.__module__.startswith("lostmotion."):
                own = room != "signals" or one.__module__.endswith("signals")
                if own and one.__qualname__ not in known:
                    missing.append(f"{room}.{name}")
    assert not missing, "add a call of each to sound_calls.py, and @checks_arguments to the function"


def test_the_sound_calls_are_sound(calls: list[Call]) -> None:
    """Those that need a longer recording, or another file, say that and nothing else."""
    refused = {}
    for call in calls:
        try:
            call.function(**call.arguments)
        except LostMotionError as error:
            refused[name_of(call)] = str(error)
    assert set(refused) == {"identify", "compare_contacts", "read_torsional_model", "design_excitation"}, (
        refused
    )


def test_numbers_may_be_numpys_and_whole() -> None:
    shaft = lm.Shaft(np.float32(100.0), np.array(0.5), 0)  # type: ignore[arg-type]
    assert (shaft.stiffness, shaft.damping, shaft.backlash) == (100.0, 0.5, 0.0)
    with pytest.raises(InvalidInput, match=r"Shaft\.stiffness: got '100', expected a finite number"):
        lm.Shaft("100")  # type: ignore[arg-type]

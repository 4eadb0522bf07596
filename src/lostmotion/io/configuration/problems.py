"""All that is wrong with a TOML and the recordings that it names, found at once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ...argument_checks import checks_arguments
from ...errors import InputProblems, InvalidInput, Problem
from ...recording import Recording
from ..storage.toml_files import read_toml
from ..storage.whole_files import read_bytes
from .models import RecordingModel
from .read import Configuration, RecordingSource, file_of, load_recordings, read_configuration
from .values import SeveralProblems

#: Without these start values there is no identification by prediction error (``stages.parameters``).
_START = ("inertia_motor", "inertia_load", "stiffness")


@checks_arguments
def find_problems(path: str | Path) -> tuple[Problem, ...]:
    """Every problem of a TOML and of its recordings, warnings included; errors in one hide none of the other."""
    path = Path(path)
    try:
        configuration = read_configuration(path)
    except InputProblems as error:
        return (*error.problems, *_of_recordings(path))
    try:
        loaded = load_recordings(configuration)
    except InputProblems as error:
        return (*error.problems, *_purpose(configuration, ()))
    found = [problem for _, recording in loaded for problem in recording.meta["problems"]]
    return (*found, *_purpose(configuration, [r for use, r in loaded if use == "identify"]))


def _purpose(configuration: Configuration, recordings: Sequence[Recording]) -> list[Problem]:
    """The warnings that a run of this TOML would identify nothing."""
    where, found = str(configuration.path), []
    if all(source.use == "validate" for source in configuration.recordings):
        found.append(
            Problem(
                "warning",
                where,
                "no recording to identify from",
                'at least one with use = "identify"',
                'Set use = "identify" for one, else the nameplate is all that is known.',
            )
        )
    missing = [name for name in _START if name not in configuration.nameplate]
    if missing and any("torque_motor" in recording for recording in recordings):
        found.append(
            Problem(
                "warning",
                f"{where}, nameplate",
                f"no {', '.join(missing)}",
                "a rough start value for each: without it nothing is identified by prediction error",
                "Add it to [nameplate]; a factor of three off will do.",
            )
        )
    return found


def _of_recordings(path: Path) -> list[Problem]:
    """Problems of the recordings that a TOML with errors names, as far as it can be understood."""
    try:
        content, _ = read_toml(path, "")
    except InvalidInput:
        return []
    recordings = content.get("recording")
    problems: list[Problem] = []
    for entry in recordings if isinstance(recordings, list) else ():
        try:
            problems += _of_recording(entry, path)
        except InputProblems as error:
            problems += error.problems
        except InvalidInput as error:
            problems.append(error.problem)
    return problems


def _of_recording(entry: Any, path: Path) -> tuple[Problem, ...]:
    """Problems of one recording, read without the keys that are wrong; InvalidInput where it cannot be read."""
    kept, wrong = _without_wrong_keys(entry)
    if "file" not in kept:
        return ()
    try:
        file = file_of(path, kept["file"], "")
    except InvalidInput:
        return ()  # said already, of the TOML
    if wrong & {"time", "channels"}:
        read_bytes(file)  # any complaint about its columns could be about the missing keys
        return ()
    model = RecordingModel.model_validate(kept)
    fields = {name: getattr(model, name) for name in type(model).model_fields}
    return tuple(RecordingSource(**{**fields, "file": file}).read().meta["problems"])


def _without_wrong_keys(entry: Any) -> tuple[dict[str, Any], set[str]]:
    """A recording's table without what is wrong in it, and the keys that were left out whole."""
    kept = dict(entry) if isinstance(entry, dict) else {}
    wrong: set[str] = set()
    try:
        RecordingModel.model_validate(kept)
    except ValidationError as error:
        for one in error.errors():
            cause = one.get("ctx", {}).get("error")
            if isinstance(cause, SeveralProblems):
                # Each place begins with the signal's name: the other channels can be read.
                bad = {problem.where.split(",")[0] for problem in cause.problems}
                kept["channels"] = {k: v for k, v in kept["channels"].items() if k not in bad}
                wrong |= set() if kept["channels"] else {"channels"}
            else:
                wrong.add(str(one["loc"][0]))
    return {key: value for key, value in kept.items() if key not in wrong}, wrong

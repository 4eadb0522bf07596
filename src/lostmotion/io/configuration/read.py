"""Configuration: what a user's TOML says, in SI; read, checked and used without knowing how it is written."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ...argument_checks import checks_arguments
from ...errors import InputProblems, InvalidInput, Problem
from ...plain_data import shown
from ...recording import Recording
from ..recordings.alignment import aligned
from ..recordings.checks import check_identifiable
from ..recordings.plausibility import check_law, check_nameplate
from ..recordings.read import read_recording
from ..storage.toml_files import read_toml
from ..tables.channels import Channel
from .methods import METHODS, options

_VARIABLE = re.compile(r"\$\{(\w+)(?::-([^}]*))?\}")
_ADDRESS = re.compile(r"\w{2,}://", re.ASCII)
_TABLE = re.compile(r"\s*\[(\[?)\s*([\w.\-\"]+)\s*\]")
_KEY = re.compile(r"\s*([\w.\-\"]+)\s*=")


@dataclass(frozen=True)
class FurtherSource:
    """A further file of a recording: the arguments of ``read_recording`` and ``aligned``."""

    file: Path
    time: Any = None
    channels: Mapping[str, Channel] = field(default_factory=dict)
    by: str | None = None
    delay: float | None = None


@dataclass(frozen=True)
class RecordingSource:
    """One ``[[recording]]``: the arguments of ``read_recording``, and what the recording is for.

    Parameters
    ----------
    file : Path
        Absolute, or relative to the working folder as the TOML's own path is.
    use : {"identify", "validate"}, or a test out of ``METHODS``
    time : mapping, str, int or None
        A column, or ``{"sample_time": seconds}``.
    channels : mapping of signal → Channel
    window : (start, stop), s, optional
    resample : float (s), bool or None
    speed_from_counts : bool or None
    options : mapping
        Arguments of the test, SI.
    further : tuple of FurtherSource
        Files with more signals.
    """

    file: Path
    use: str = "identify"
    time: Any = None
    channels: Mapping[str, Channel] = field(default_factory=dict)
    window: tuple[float, float] | None = None
    resample: float | bool | None = None
    speed_from_counts: bool | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    further: tuple[FurtherSource, ...] = ()

    @property
    def files(self) -> tuple[Path, ...]:
        """All files of the recording."""
        return (self.file, *(one.file for one in self.further))

    def read(self) -> Recording:
        """The recording in SI; raises ``InputProblems`` with all its errors."""
        recording = read_recording(
            self.file,
            time=self.time,
            channels=self.channels or None,
            window=self.window,
            resample=self.resample,
            speed_from_counts=self.speed_from_counts,
        )
        for one in self.further:
            other = read_recording(one.file, time=one.time, channels=one.channels or None)
            try:
                recording = aligned(recording, other, by=one.by, delay=one.delay)
            except InvalidInput as error:
                raise InputProblems([replace(error.problem, where=str(one.file))]) from None
        return recording


@dataclass(frozen=True)
class IdentifySettings:
    """``[identify]``: parameters that keep their nameplate value; whether an unknown torque acts on the load; further
    signals that are used."""

    fixed: tuple[str, ...] = ()
    load_torque: bool = False
    measured: tuple[str, ...] = ()


@dataclass(frozen=True)
class LawSettings:
    """``[law]``: sample time (s; None: the recording's), torque limit (Nm), poles (1/s), PI.

    ``kp`` (Nm s/rad) and ``ki`` (Nm/rad) are both given or both None. None: from the drive, see ``stages.design``.
    """

    sample_time: float | None = None
    torque_limit: float | None = None
    poles: tuple[float, ...] | None = None
    kp: float | None = None
    ki: float | None = None


@dataclass(frozen=True)
class RunSettings:
    """``[run]``: the seed of everything random in the run."""

    seed: int = 1


@dataclass(frozen=True)
class Configuration:
    """What a TOML says: start values (SI, only those given), recordings, how to identify, law, run."""

    path: Path
    nameplate: Mapping[str, float]
    recordings: tuple[RecordingSource, ...]
    identify: IdentifySettings = field(default_factory=IdentifySettings)
    law: LawSettings = field(default_factory=LawSettings)
    run: RunSettings = field(default_factory=RunSettings)


@checks_arguments
def read_configuration(path: str | Path) -> Configuration:
    """Read and check a TOML; docs/configuration.md describes every key.

    Raises
    ------
    InputProblems
        All problems of the TOML together, each with its line and key.
    """
    path = Path(path)
    try:
        content, text = read_toml(
            path,
            "a TOML that names recordings",
            "A recording is named in a TOML: write one with lostmotion init, with "
            f'file = "{path.name}" in its [[recording]].',
        )
    except InvalidInput as error:
        raise InputProblems([error.problem]) from None
    return configuration_in(content, text, path)


def configuration_in(content: dict[str, Any], text: str, path: Path) -> Configuration:
    """The configuration in what ``read_toml`` gives; raises ``InputProblems`` as ``read_configuration``."""
    if content.get("kind") == "drivetrain":
        error = InvalidInput(
            str(path),
            "a drivetrain, which a run writes",
            "a TOML that names recordings",
            "Name the one that the run was given; lostmotion simulate and excite take a drivetrain.",
        )
        raise InputProblems([error.problem])
    from .models import validated

    lines = _lines_of_keys(text)
    nameplate, sources, tables = validated(content, lambda location: _place(path, location, lines))
    recordings, problems = [], []
    for i, source in enumerate(sources):
        try:
            file = file_of(path, source["file"], _place(path, ("recording", i, "file"), lines))
            given = options(source["use"], source["options"])
            further = tuple(
                FurtherSource(
                    file_of(path, one.file, _place(path, ("recording", i, "further", j, "file"), lines)),
                    one.time, one.channels, one.by, one.delay,
                )
                for j, one in enumerate(source["further"])
            )  # fmt: skip
            made = {**source, "file": file, "options": given, "further": further}
            recordings.append(RecordingSource(**made))
        except InvalidInput as error:
            problems.append(error.problem)
    if problems:
        raise InputProblems(problems)
    return Configuration(
        path,
        MappingProxyType(nameplate),
        tuple(recordings),
        IdentifySettings(**tables["identify"]),
        LawSettings(**tables["law"]),
        RunSettings(**tables["run"]),
    )


@checks_arguments
def load_recordings(configuration: Configuration) -> list[tuple[str, Recording]]:
    """All recordings of a configuration with their use (``identify``, ``validate`` or a test), in its order.

    Raises
    ------
    InputProblems
        If a file has an error: the problems of all files together, warnings included.
    """
    loaded: list[tuple[str, Recording]] = []
    problems: list[Problem] = []
    law = configuration.law
    for source in configuration.recordings:
        try:
            recording = source.read()
            if source.use == "identify":
                recording = _with_problems(
                    recording,
                    *check_identifiable(recording),
                    *check_nameplate(recording, configuration.nameplate),
                    *check_law(recording, law.torque_limit, law.poles, law.sample_time, law.kp),
                )
            recording = _with_problems(recording, *_not_used(source, configuration.recordings))
            loaded.append((source.use, recording))
            problems.extend(recording.meta["problems"])
        except InputProblems as error:
            problems.extend(error.problems)
    if any(problem.severity == "error" for problem in problems):
        raise InputProblems(problems)
    return loaded


def _with_problems(recording: Recording, *further: Problem) -> Recording:
    return replace(recording, meta={**recording.meta, "problems": (*recording.meta["problems"], *further)})


def _not_used(source: RecordingSource, sources: Sequence[RecordingSource]) -> list[Problem]:
    """Warnings that a recording is not the first of its use, or is the one that was identified from."""
    found, where = [], str(source.file)
    if source.use not in METHODS and next(one for one in sources if one.use == source.use) is not source:
        remedy = "Only the first is used: join the recordings, or run again with another one first."
        got, expected = f"a further recording to {source.use}", f"one recording to {source.use}"
        found.append(Problem.warning(where, got, expected, remedy))
    identified = [one for one in sources if one.use == "identify"]
    if source.use == "validate" and any(
        (one.file, one.window) == (source.file, source.window) for one in identified
    ):
        got = "the recording to validate is that to identify from"
        remedy = "Give another one or another window, or leave it out: the last part is then kept for it."
        found.append(Problem.warning(where, got, "one that nothing was fitted to", remedy))
    return found


def template() -> str:
    """A commented TOML with every key, to be filled in by the user."""
    return (Path(__file__).parent / "template.toml").read_text(encoding="utf-8")


def file_of(toml: Path, file: str, where: str) -> Path:
    """The file that a TOML names, relative to it.

    ``${NAME}`` and ``${NAME:-default}`` are replaced from the environment, ~ by the home folder.
    """

    if _ADDRESS.match(file):
        raise InvalidInput(
            where, f"the address {shown(file)}", "a file of this machine", "Download it first."
        )

    def value(match: re.Match[str]) -> str:
        found = os.environ.get(match[1]) or match[2]
        if found is None:
            raise InvalidInput(
                where,
                f"the environment variable {match[1]}, which is not set",
                "its value",
                f"Set it, or write ${{{match[1]}:-default/folder}}.",
            )
        return found

    try:
        return toml.parent / Path(_VARIABLE.sub(value, file)).expanduser()
    except RuntimeError:
        raise InvalidInput(
            where,
            f"the home folder of {shown(file.split('/')[0])}",
            "a user of this machine",
            "Write the path out.",
        ) from None


def _place(path: Path, location: tuple[str | int, ...], lines: dict[tuple[str | int, ...], int]) -> str:
    """``rig.toml, line 12, recording[0].channels.speed_motor``; the line of the nearest key that has one."""
    key = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in location).lstrip(".")
    for end in range(len(location), 0, -1):
        if location[:end] in lines:
            return f"{path}, line {lines[location[:end]]}, {key}"
    return f"{path}, {key}" if key else str(path)


def _lines_of_keys(text: str) -> dict[tuple[str | int, ...], int]:
    """Line of every table and key, found without parsing: good enough to point at it."""
    lines: dict[tuple[str | int, ...], int] = {}
    counts: dict[str, int] = {}
    table: tuple[str | int, ...] = ()
    for number, line in enumerate(text.splitlines(), 1):
        if match := _TABLE.match(line):
            names = match[2].replace('"', "").split(".")
            if match[1] and len(names) == 1:
                counts[names[0]] = counts.get(names[0], -1) + 1
            table = (names[0], counts[names[0]], *names[1:]) if names[0] in counts else tuple(names)
        elif match := _KEY.match(line):
            key = (*table, *match[1].replace('"', "").split("."))
            lines.setdefault(key, number)
            continue
        else:
            continue
        lines.setdefault(table, number)
    return lines

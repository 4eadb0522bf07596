"""What a command works on: a user's TOML, a saved recording, a drivetrain, or the virtual rig; and what it reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..io import Configuration, read_configuration, read_recording
from ..io.configuration.read import configuration_in
from ..io.storage.drivetrain_files import EXPECTED, drivetrain_in
from ..io.storage.toml_files import read_toml
from ..recording import Recording
from ..stages.material import Material, from_configuration, from_recording, from_rig
from ..stages.parameters import two_mass


@dataclass(frozen=True)
class RecordingFile:
    """A TOML of the main job, a saved recording (.npz), or neither: the virtual rig. A TOML is read once."""

    path: Path | None = None
    configuration: Configuration | None = None

    @property
    def reads(self) -> tuple[Path, ...]:
        """The file, and the recordings that a TOML names."""
        return (() if self.path is None else (self.path,)) + recordings_of(self.configuration)

    def material(self, seed: int | None) -> Material:
        """The TOML's recordings, whole, a saved one, or those of the virtual rig with this seed."""
        if self.configuration is None and self.path is not None:
            return from_recording(read_recording(self.path), 1 if seed is None else seed)
        if self.configuration is None:
            return from_rig(1 if seed is None else seed)[0]
        return from_configuration(self.configuration, seed, split=False)

    def recording(self, seed: int | None) -> tuple[Recording, tuple[Problem, ...]]:
        """The saved recording, or the first to identify of the TOML or of the virtual rig; and the warnings."""
        if self.path is not None and self.configuration is None:
            recording = read_recording(self.path)
            return recording, tuple(recording.meta["problems"])
        material = self.material(seed)
        if material.identify is None:
            raise InvalidInput(
                str(self.path), "no recording with use = 'identify'", "at least one", "Add it to the TOML."
            )
        return material.identify, material.problems


def toml_or_rig(path: Path | None) -> RecordingFile:
    """The TOML with its recordings, or without one the virtual rig; raises ``InputProblems``."""
    return RecordingFile() if path is None else RecordingFile(path, read_configuration(path))


def toml_recording_or_rig(path: Path | None) -> RecordingFile:
    """A saved recording besides; it is read where it is asked for."""
    return RecordingFile(path) if path is not None and path.suffix == ".npz" else toml_or_rig(path)


@dataclass(frozen=True)
class DriveFile:
    """A drivetrain.toml, or a TOML of the main job with the drivetrain of its nameplate; read once."""

    path: Path
    drivetrain: Drivetrain
    configuration: Configuration | None = None

    @property
    def reads(self) -> tuple[Path, ...]:
        """The file, and the recordings that it names."""
        return (self.path, *recordings_of(self.configuration))


def read_drive(path: Path) -> DriveFile:
    """The drivetrain that a file gives; raises ``InvalidInput`` or ``InputProblems`` where it gives none."""
    content, text = read_toml(path, *EXPECTED)
    if "nameplate" not in content:
        return DriveFile(path, drivetrain_in(content, text, str(path)))
    configuration = configuration_in(content, text, path)
    missing = [n for n in ("inertia_motor", "inertia_load", "stiffness") if n not in configuration.nameplate]
    if missing:
        raise InvalidInput(
            str(path), f"no {', '.join(missing)} in [nameplate]", "rough values of these", "Add them."
        )
    return DriveFile(path, two_mass(configuration.nameplate), configuration)


def recordings_of(configuration: Configuration | None) -> tuple[Path, ...]:
    """The files of the recordings that a TOML names; none without one."""
    return () if configuration is None else tuple(f for one in configuration.recordings for f in one.files)

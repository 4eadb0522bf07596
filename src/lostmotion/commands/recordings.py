"""What a command works on: a user's TOML, a saved recording, a drivetrain, or the virtual rig; and what it reads."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..io import Configuration, read_configuration, read_recording
from ..io.configuration.read import configuration_in
from ..io.storage.drivetrain_files import EXPECTED, drivetrain_in
from ..io.storage.toml_files import read_toml
from ..io.storage.whole_files import read_bytes
from ..recording import Recording
from ..stages.material import Material, from_configuration, from_rig
from ..stages.parameters import two_mass


def material_of(file: Path | None, seed: int | None) -> Material:
    """The TOML's recordings, whole, or without one those of the virtual rig with this seed."""
    if file is None:
        return from_rig(1 if seed is None else seed)[0]
    return from_configuration(read_configuration(file), seed, split=False)


def files_read(file: Path | None) -> tuple[Path, ...]:
    """The files that ``material_of`` and ``recording_of`` read: the file itself, and the recordings of a TOML."""
    # Path.is_file raises of names that no file can have; those are told where the file is read.
    if file is None or not os.path.isfile(file):  # noqa: PTH113
        return ()
    if file.suffix != ".toml" or b"[[recording]]" not in read_bytes(file):
        return (file,)
    return (file, *recordings_of(read_configuration(file)))


def recording_of(file: Path | None, seed: int | None) -> tuple[Recording, tuple[Problem, ...]]:
    """A saved .npz, or the first recording to identify of a TOML or of the virtual rig; and the warnings."""
    if file is not None and file.suffix == ".npz":
        recording = read_recording(file)
        return recording, tuple(recording.meta["problems"])
    material = material_of(file, seed)
    if material.identify is None:
        raise InvalidInput(
            str(file), "no recording with use = 'identify'", "at least one", "Add it to the TOML."
        )
    return material.identify, material.problems


@dataclass(frozen=True)
class DriveFile:
    """A drivetrain.toml, or a TOML of the main job with the drivetrain of its nameplate; read once."""

    path: Path
    drivetrain: Drivetrain
    configuration: Configuration | None = None

    @property
    def reads(self) -> tuple[Path, ...]:
        """The file, and the recordings that it names."""
        return (self.path, *(() if self.configuration is None else recordings_of(self.configuration)))


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


def recordings_of(configuration: Configuration) -> tuple[Path, ...]:
    """The files of the recordings that a TOML names."""
    return tuple(Path(one.file) for one in configuration.recordings)

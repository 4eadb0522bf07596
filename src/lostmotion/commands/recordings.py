"""What a command works on: a user's TOML, a saved recording, a drivetrain, or the virtual rig."""

from __future__ import annotations

from pathlib import Path

from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..io import load_drivetrain, read_configuration, read_recording
from ..io.storage.whole_files import read_bytes
from ..recording import Recording
from ..stages.material import Material, from_configuration, from_rig
from ..stages.parameters import two_mass


def material_of(file: Path | None, seed: int | None) -> Material:
    """The TOML's recordings, whole, or without one those of the virtual rig with this seed."""
    if file is None:
        return from_rig(1 if seed is None else seed)[0]
    return from_configuration(read_configuration(file), seed, split=False)


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


def drivetrain_of(file: Path) -> Drivetrain:
    """A drivetrain.toml's drivetrain, or the nameplate of a TOML of the main job."""
    try:
        return load_drivetrain(file)
    except InvalidInput as error:
        if b"[nameplate]" not in read_bytes(file):
            raise
        nameplate = read_configuration(file).nameplate
        missing = [n for n in ("inertia_motor", "inertia_load", "stiffness") if n not in nameplate]
        if missing:
            raise InvalidInput(
                str(file), f"no {', '.join(missing)} in [nameplate]", "rough values of these", "Add them."
            ) from error
        return two_mass(nameplate)

"""The recordings that a command works on: a user's TOML, a saved recording, or the virtual rig."""

from __future__ import annotations

from pathlib import Path

from ..errors import InvalidInput
from ..io import load_recording, read_configuration
from ..recording import Recording
from ..stages.material import Material, from_configuration, from_rig


def material_of(file: Path | None, seed: int | None) -> Material:
    """The TOML's recordings, or without one those of the virtual rig with this seed."""
    if file is None:
        return from_rig(1 if seed is None else seed)[0]
    return from_configuration(read_configuration(file), seed)


def recording_of(file: Path | None, seed: int | None) -> Recording:
    """A saved .npz, or the first recording to identify of a TOML or of the virtual rig."""
    if file is not None and file.suffix == ".npz":
        return load_recording(file)
    recording = material_of(file, seed).identify
    if recording is None:
        raise InvalidInput(
            str(file), "no recording with use = 'identify'", "at least one", "Add it to the TOML."
        )
    return recording


def beside(out: Path, suffix: str) -> Path:
    """The output file of this suffix: ``out`` is a name without one; its folder is created."""
    out.parent.mkdir(parents=True, exist_ok=True)
    return out.with_name(out.name + suffix)

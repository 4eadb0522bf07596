"""What a command works on, a user's TOML, a saved recording or the virtual rig, and where it writes."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..io import load_drivetrain, load_recording, read_configuration
from ..io.storage.whole_files import read_bytes, write_bytes
from ..recording import Recording
from ..stages.material import Material, from_configuration, from_rig
from ..stages.parameters import two_mass

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def material_of(file: Path | None, seed: int | None) -> Material:
    """The TOML's recordings, whole, or without one those of the virtual rig with this seed."""
    if file is None:
        return from_rig(1 if seed is None else seed)[0]
    return from_configuration(read_configuration(file), seed, split=False)


def recording_of(file: Path | None, seed: int | None) -> tuple[Recording, tuple[Problem, ...]]:
    """A saved .npz, or the first recording to identify of a TOML or of the virtual rig; and the warnings."""
    if file is not None and file.suffix == ".npz":
        return load_recording(file), ()
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


def outputs(out: Path, *suffixes: str, source: Path | None = None) -> tuple[Path, ...]:
    """The files to write: ``out`` is their name without a suffix; its folder is created.

    To be called before anything is computed: raises ``InvalidInput`` where they cannot be written, or would take the
    place of the ``source`` or of a recording that it names.
    """
    if not out.name:
        raise InvalidInput(str(out), "a folder", "the name of the files to write", "Add a name.")
    files = tuple(out.with_name(out.name + suffix) for suffix in suffixes)
    check_writable(*files, source=source)
    return files


def check_writable(*files: Path, source: Path | None = None) -> None:
    """Create the folders of the files; raises ``InvalidInput`` where one of the files cannot be written.

    Or must not: the source, a TOML, and the recordings that it names stay as they are.
    """
    kept = _read_by(source)
    for file in files:
        if file.resolve() in kept:
            raise InvalidInput(
                str(file), f"a file that {source} is or reads", "another name", "Choose it with --out."
            )
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            with TemporaryFile(dir=file.parent):
                pass
        except OSError as error:
            raise InvalidInput(
                str(file.parent), str(error.strerror or error), "a folder to write into", "Choose another."
            ) from None
        if file.is_dir():
            raise InvalidInput(str(file), "a folder", "the name of a file", "Choose another name.")


def _read_by(source: Path | None) -> set[Path]:
    """The file itself, and the recordings of a TOML of the main job."""
    if source is None or not source.is_file():
        return set()
    kept = {source.resolve()}
    if source.suffix == ".toml" and b"[[recording]]" in read_bytes(source):
        kept |= {Path(one.file).resolve() for one in read_configuration(source).recordings}
    return kept


def save_picture(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, whole or not at all; raises ``InvalidInput`` where that fails."""
    picture = BytesIO()
    figure.savefig(picture, format="png", dpi=110, facecolor="white")
    write_bytes(path, picture.getvalue())

"""Where a command writes: checked before anything is computed; nobody else's file is replaced."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from ..io import read_configuration
from ..io.storage.whole_files import read_bytes, write_bytes
from ..io.storage.written_files import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@contextmanager
def outputs(
    out: Path, *suffixes: str, sources: tuple[Path | None, ...] = (), force: bool = False
) -> Iterator[tuple[Path, ...]]:
    """The files to write, around their writing: ``out`` is their name without a suffix; its folder is created.

    Raises
    ------
    InvalidInput
        Before anything is computed: where a file cannot be written, is one of the sources or a recording that they
        name, or is there and not as this package wrote it (unless ``force``).
    """
    if not out.name:
        raise InvalidInput(str(out), "a folder", "the name of the files to write", "Add a name.")
    files = tuple(out.with_name(out.name + suffix) for suffix in suffixes)
    check_writable(*files, sources=sources)
    with replacing(*files, force=force):
        yield files


def check_writable(*files: Path, sources: tuple[Path | None, ...] = ()) -> None:
    """Create the folders of the files; raises ``InvalidInput`` where one of them cannot be written.

    Or must not: the sources, and the recordings that a TOML among them names, stay as they are.
    """
    for file in files:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            with TemporaryFile(dir=file.parent):
                pass
            place, is_folder = file.resolve(), file.is_dir()
        except (OSError, ValueError) as error:
            said = getattr(error, "strerror", None) or "a name that no file can have"
            raise InvalidInput(str(file.parent), said, "a folder to write into", "Choose another.") from None
        if is_folder:
            raise InvalidInput(str(file), "a folder", "the name of a file", "Choose another name.")
        for source in sources:
            if place in _read_by(source):
                raise InvalidInput(
                    str(file), f"a file that {source} is or reads", "another name", "Choose it with --out."
                )


def _read_by(source: Path | None) -> set[Path]:
    """The file itself, and the recordings of a TOML of the main job."""
    # Path.is_file raises of names that no file can have; those are told where the file is read.
    if source is None or not os.path.isfile(source):  # noqa: PTH113
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

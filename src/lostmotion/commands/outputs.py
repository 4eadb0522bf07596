"""Where a command writes: checked before anything is computed; no file of others is replaced."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING

from ..errors import InvalidInput
from ..io.storage.whole_files import write_bytes
from ..io.storage.written_files import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure


#: Endings of the files that commands write.
ENDINGS = (".csv", ".json", ".png")


def stem(out: Path) -> Path:
    """What the names of a command's files begin with: one of ``ENDINGS`` is left out, others belong to the name."""
    return out.with_suffix("") if out.suffix in ENDINGS else out


@contextmanager
def outputs(
    out: Path, *suffixes: str, sources: tuple[Path, ...] = (), force: bool = False
) -> Iterator[tuple[Path, ...]]:
    """The files to write, around their writing: the ``stem`` of ``out`` with each suffix; its folder is created.

    Raises
    ------
    InvalidInput
        Before anything is computed: where a file cannot be written, is one of the sources, or is there and not as this
        package wrote it (unless ``force``).
    """
    if out.name in ("", ".."):
        raise InvalidInput(str(out), "a folder", "the name of the files to write", "Add a name.")
    if os.path.exists(out) and not (os.path.isfile(out) or os.path.isdir(out)):  # noqa: PTH110, PTH112, PTH113
        raise InvalidInput(
            str(out), "a device or a pipe", "the name of the files to write", "Choose another name."
        )
    files = tuple(Path(f"{stem(out)}{suffix}") for suffix in suffixes)
    check_writable(*files, sources=sources)
    with replacing(*files, force=force):
        yield files


def check_writable(*files: Path, sources: tuple[Path, ...] = ()) -> None:
    """Create the folders of the files; raises ``InvalidInput`` where one of them cannot be written.

    Or must not: the sources stay as they are.
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
        # os.path.isfile: Path.is_file raises of names that no file can have; those are reported where the file is read.
        if any(os.path.isfile(source) and place == source.resolve() for source in sources):  # noqa: PTH113
            raise InvalidInput(
                str(file), "a file that this command reads", "another name", "Choose it with --out."
            )


def save_picture(figure: Figure, path: Path) -> None:
    """Write a figure as PNG, whole or not at all; raises ``InvalidInput`` where that fails."""
    picture = BytesIO()
    figure.savefig(picture, format="png", dpi=110, facecolor="white")
    write_bytes(path, picture.getvalue())

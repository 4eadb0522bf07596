"""Reading and writing whole files, with errors that a user can act on."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path

from ...errors import InvalidInput
from ...memory import check_memory
from ..spelling import short_list

#: Bytes that are read of a file that says no size, as those of /proc do (option).
_UNSIZED = 1_000_000


def read_bytes(path: str | Path, *, takes: float = 1.0) -> bytes:
    """The file's content.

    Parameters
    ----------
    path : path
    takes : float
        Bytes of memory that its reader takes for each byte of the file.

    Raises
    ------
    InvalidInput
        If it cannot be read, is no file (a folder, a pipe, a device: they may have no end), or would take more than
        the memory limit.
    """
    try:
        status = Path(path).stat()
        if not stat.S_ISREG(status.st_mode):
            raise _no_file(path, status.st_mode)
        what = f"a file of {status.st_size / 1e6:.3g} MB"
        check_memory(str(path), what, takes * status.st_size, "Cut the recording, or leave columns out.")
        with open(path, "rb", opener=_without_waiting) as stream:
            return stream.read(status.st_size or _UNSIZED)
    except InvalidInput:
        raise
    except FileNotFoundError:
        got = "a link to a file that is not there" if Path(path).is_symlink() else "no such file"
        raise InvalidInput(str(path), got, "a readable file", _near(Path(path))) from None
    except OSError as error:
        raise InvalidInput(
            str(path), str(error.strerror or error), "a readable file", "Check path and permissions."
        ) from None
    except ValueError:  # NUL
        raise InvalidInput(
            str(path), "a name that no file can have", "a readable file", "Check the path."
        ) from None


def _without_waiting(path: str, flags: int) -> int:
    """Opens what may have become a pipe meanwhile."""
    return os.open(path, flags | getattr(os, "O_NONBLOCK", 0))


def _no_file(path: str | Path, mode: int) -> InvalidInput:
    kinds = {
        stat.S_IFDIR: ("a folder", "Name the file in it."),
        stat.S_IFIFO: ("a pipe", "Write what comes out of it to a file first."),
        stat.S_IFCHR: ("a device", "Write what comes out of it to a file first."),
        stat.S_IFBLK: ("a device", "Name a file on it."),
        stat.S_IFSOCK: ("a socket", "Write what comes out of it to a file first."),
    }
    got, remedy = kinds.get(stat.S_IFMT(mode), ("something that is no file", "Name a file."))
    return InvalidInput(str(path), got, "a readable file", remedy)


def _no_place(path: Path) -> InvalidInput:
    """A folder, a device, a pipe: what takes its place would end it."""
    kind = "a folder" if path.is_dir() else "a device or a pipe"
    return InvalidInput(str(path), kind, "the name of a file", "Choose another name.")


def _near(path: Path) -> str:
    """The remedy for a missing file: what of its kind lies in its folder."""
    try:
        near = sorted(
            file.name
            for file in path.parent.iterdir()
            if file.suffix == path.suffix and not file.name.startswith(".") and file.is_file()
        )
    except OSError:
        near = []
    return f"In that folder: {short_list(near)}." if near else "Check the path."


def make_folder(path: Path) -> None:
    """The folder and its parents, where they are missing; raises ``InvalidInput`` where that fails."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        said = getattr(error, "strerror", None) or "a name that no folder can have"
        raise InvalidInput(str(path), said, "a folder to write into", "Choose another.") from None


def write_bytes(path: str | Path, content: bytes) -> None:
    """Write all or nothing; raises ``InvalidInput`` where that fails."""
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


@contextlib.contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """A sibling to write to, which takes the file's place when the block ends without an exception.

    Raises ``InvalidInput`` where it cannot be written.
    """
    path = Path(path)
    # Its own name in it could be too long for a file.
    temporary = path.parent / f".lostmotion-{os.getpid()}-{secrets.token_hex(4)}.partial"
    try:
        try:
            if path.exists() and not path.is_file():
                raise _no_place(path)
            yield temporary
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except InvalidInput:
        raise
    except (OSError, ValueError) as error:
        said = getattr(error, "strerror", None) or "a name that no file can have"
        raise InvalidInput(
            str(path), said, "a place that can be written", "Check folder, rights, space."
        ) from None

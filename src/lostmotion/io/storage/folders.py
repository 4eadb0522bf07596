"""output_folder: a folder of results that appears whole or not at all, and takes no files of others away."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import secrets
import shutil
import socket
from collections.abc import Iterator
from pathlib import Path

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ..spelling import short_list
from .written_files import MANIFEST, Written, content_hash, save_written, written_in

#: Errors of the place, not of the program: no space, no quota (unknown to Windows), read-only.
_NO_ROOM = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC), errno.EROFS)


@contextlib.contextmanager
@checks_arguments
def output_folder(path: str | Path, force: bool = False) -> Iterator[Path]:
    """A temporary folder beside ``path`` that takes its place when the block ends without an exception.

    The files of an earlier run in ``path`` are replaced. Any other file there, or one of them that was changed
    since, makes it refuse, unless ``force`` is given: such a file is then kept, with ``.kept`` behind its name if
    the run wrote one of the same name. On any exception, and when the process is killed, the previous folder
    stays as it was; what a killed run left beside it is removed, or put back, by the next run.

    Parameters
    ----------
    path : path
        Parents are created. A link to a folder is followed.
    force : bool
        Go on although files lie in ``path`` that no run has written.

    Yields
    ------
    Path
        The folder to write into, on the same file system as ``path``.

    Raises
    ------
    InvalidInput
        Before the block runs: if ``path`` is a file, the working folder or above it, holds foreign files
        without ``force``, or cannot be written. After it: if the disk is full or the folder cannot be put in
        place.
    """
    path = _possible(Path(path))
    _clean_up(path)
    _refuse_foreign(path, force)
    new = _sibling(path, "new")
    try:
        new.mkdir(parents=True)
    except OSError as error:
        raise _cannot_write(path, error) from None
    try:
        yield new
        run = {name: content_hash(new / name) for name in _files(new)}
        _keep_foreign(path, new)
        others = (written_in(path) or Written({}, {})).files
        save_written(new, Written(run, {name: found for name, found in others.items() if name not in run}))
        _swap(path, new)
    except OSError as error:
        if error.errno in _NO_ROOM:
            raise _cannot_write(path, error) from error
        raise
    except InvalidInput as error:
        p = error.problem
        if not Path(p.where).is_relative_to(new):
            raise
        # The user knows the folder by the name that it was going to have.
        place = path / Path(p.where).relative_to(new)
        raise InvalidInput(str(place), p.got, p.expected, p.remedy) from error
    finally:
        shutil.rmtree(new, ignore_errors=True)


@checks_arguments
def foreign_files(path: str | Path) -> list[str]:
    """Files (and empty folders) in a folder that no run has written, or not as they are now, relative to it."""
    path = Path(path)
    if not os.path.isdir(path):  # noqa: PTH112
        return []
    known = written_in(path)
    own = {} if known is None else known.run
    broken = [MANIFEST] if known is None and os.path.lexists(path / MANIFEST) else []
    return broken + [name for name in _files(path) if own.get(name) != content_hash(path / name)]


def _files(folder: Path) -> list[str]:
    """Every file, link and empty folder below a folder, relative, sorted, but manifests; empty folders end with a
    slash."""
    found: list[str] = []
    for root, folders, files in os.walk(folder):
        place = Path(root)
        links = [name for name in folders if (place / name).is_symlink()]
        names = (name for name in (*files, *links) if name != MANIFEST)
        found += [(place / name).relative_to(folder).as_posix() for name in names]
        if not folders and not files and place != folder:
            found.append(place.relative_to(folder).as_posix() + "/")
    return sorted(found)


def _possible(path: Path) -> Path:
    """The whole path, links followed; raises ``InvalidInput`` of a name that no folder can have."""
    try:
        path = path.resolve()
        with contextlib.suppress(FileNotFoundError):
            path.stat()
    except (OSError, ValueError) as error:
        raise _cannot_write(path, error) from None
    return path


def _refuse_foreign(path: Path, force: bool) -> None:
    if path.exists() and not path.is_dir():
        raise InvalidInput(str(path), "a file", "a folder", "Choose another name for the output.")
    if Path.cwd().is_relative_to(path):
        raise InvalidInput(
            str(path),
            "the working folder, or one above it",
            "a folder that can be replaced",
            "Choose one below it.",
        )
    foreign = foreign_files(path)
    if foreign and not force:
        raise InvalidInput(
            str(path),
            f"{len(foreign)} files that no run has written, or that were changed since: {short_list(foreign, 5)}",
            "a new or empty folder, or the output of an earlier run",
            "Choose another folder, or force it: those files are kept.",
        )


def _keep_foreign(path: Path, new: Path) -> None:
    """Foreign files also go into the new folder, as hard links where possible: the old one stays whole."""
    for name in foreign_files(path):
        if name == MANIFEST:
            continue  # one that cannot be read is none
        source, target = path / name, new / name
        while os.path.lexists(target) and not name.endswith("/"):
            target = target.with_name(target.name + ".kept")
        if name.endswith("/"):
            target.mkdir(parents=True, exist_ok=True)
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(source, target, follow_symlinks=False)
        except (OSError, NotImplementedError):
            shutil.copy2(source, target, follow_symlinks=False)


def _swap(path: Path, new: Path) -> None:
    """Put ``new`` in place of ``path``; until then path or its sibling holds the previous output."""
    old = _sibling(path, "old")
    try:
        if path.exists():
            path.rename(old)
        new.rename(path)
    except BaseException as error:
        if old.exists() and not path.exists():
            old.rename(path)
        if isinstance(error, OSError):
            raise _cannot_write(path, error) from error
        raise
    shutil.rmtree(old, ignore_errors=True)


def _sibling(path: Path, role: str) -> Path:
    return path.with_name(f".{path.name}.{role}-{_host()}-{os.getpid()}-{secrets.token_hex(4)}")


def _host() -> str:
    return re.sub(r"\W", "_", socket.gethostname())


def _clean_up(path: Path) -> None:
    """Remove what killed runs of this machine left beside ``path``; put a previous output back in place.

    A killed run leaves its ``new`` folder; one killed between the two renames of ``_swap`` also the previous
    output as ``old``, with nothing at ``path``.
    """
    pattern = re.compile(rf"\.{re.escape(path.name)}\.(new|old)-{re.escape(_host())}-(\d+)-[0-9a-f]{{8}}")
    siblings = sorted(path.parent.iterdir()) if path.parent.is_dir() else []
    for sibling in siblings:
        match = pattern.fullmatch(sibling.name)
        if match is None or _alive(int(match[2])):
            continue
        if match[1] == "old" and not path.exists():
            sibling.rename(path)
        else:
            shutil.rmtree(sibling, ignore_errors=True)


def _alive(process: int) -> bool:
    """Whether a process of this machine runs; where that cannot be asked without harm, True."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True


def _cannot_write(path: Path, error: OSError | ValueError) -> InvalidInput:
    return InvalidInput(
        str(path),
        getattr(error, "strerror", None) or "a name that no folder can have",
        "a place that can be written, with room for the results",
        "Choose another folder; nothing there was changed.",
    )

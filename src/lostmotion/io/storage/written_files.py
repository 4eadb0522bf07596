"""What this package wrote, and with what content: nothing else, nor what was changed since, is replaced unasked."""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

from ...errors import InvalidInput
from ...plain_data import mapping, text
from ..spelling import short_list
from .json_files import load_json, save_json

#: File in every folder that this package wrote into, with a hash of each file.
MANIFEST = ".lostmotion-files.json"
_KIND = "written_files"


class Written(NamedTuple):
    """Names, relative to the manifest's folder, with hashes: of a run that made the whole folder, and of others."""

    run: Mapping[str, str]
    files: Mapping[str, str]

    @property
    def all(self) -> dict[str, str]:
        return {**self.files, **self.run}


@contextlib.contextmanager
def replacing(*files: Path, force: bool = False) -> Iterator[None]:
    """Around the writing of files: those that are there must be this package's own, as it wrote them.

    Parameters
    ----------
    files : Path
        All that the block may write. What it has written, whole or interrupted, goes into the manifests that know it,
        else into that of its folder.
    force : bool
        Replace whatever is there.

    Raises
    ------
    InvalidInput
        Before the block: if a file is there that this package has not written, or that was changed since.
    """
    check_own(*files, force=force)
    before = {file: content_hash(file) for file in files}
    try:
        yield
    finally:
        _record({file: found for file in files if (found := content_hash(file)) != before[file]})


def check_own(*files: Path, force: bool = False) -> None:
    """Raises ``InvalidInput`` where one of the files is there and not as this package wrote it."""
    foreign = [] if force else [file for file in files if not _is_own(file)]
    if foreign:
        raise InvalidInput(
            str(foreign[0].parent),
            f"{len(foreign)} file{'s' if len(foreign) > 1 else ''} that lostmotion has not written, or that "
            f"{'were' if len(foreign) > 1 else 'was'} changed since: {short_list((file.name for file in foreign), 5)}",
            "no file of that name, or one that lostmotion has written",
            "Choose another name or folder, or replace it with force (--force).",
        )


def _is_own(file: Path) -> bool:
    """Whether a file may be replaced: it is not there, or its content is what a manifest says."""
    if not os.path.lexists(file):
        return True
    return content_hash(file) in [known.all[name] for _, name, known in _known_as(file)]


def _known_as(file: Path) -> list[tuple[Path, str, Written]]:
    """Folders with a manifest that knows a file, its name there, and all that the manifest knows."""
    found = []
    for folder in file.absolute().parents:
        known, name = written_in(folder), file.absolute().relative_to(folder).as_posix()
        if known is not None and name in known.all:
            found.append((folder, name, known))
    return found


def _record(written: Mapping[Path, str]) -> None:
    for file, found in written.items():
        nothing = file.parent, file.name, written_in(file.parent) or Written({}, {})
        for folder, name, known in _known_as(file) or [nothing]:
            group = "run" if name in known.run else "files"
            changed = dict(sorted({**getattr(known, group), name: found}.items()))
            save_written(folder, known._replace(**{group: changed}))


def written_in(folder: Path) -> Written | None:
    """What the manifest of a folder says; None where there is none, or none that can be read."""
    try:
        data = load_json(folder / MANIFEST, _KIND)
        groups = (mapping(key, data.get(key, {})) for key in Written._fields)
        return Written(*({name: text(name, found) for name, found in group.items()} for group in groups))
    except InvalidInput:
        return None


def save_written(folder: Path, written: Written) -> None:
    """Write the manifest of a folder."""
    save_json(folder / MANIFEST, _KIND, written._asdict())


def content_hash(file: Path) -> str:
    """Of the content; what is no file, such as a link or an empty folder, is known by being none."""
    # These two say no, where Path's own raise, of names that no file can have.
    if os.path.islink(file) or not os.path.isfile(file):  # noqa: PTH113, PTH114
        return "no file"
    digest = hashlib.sha256()
    try:
        with file.open("rb") as stream:
            while part := stream.read(1 << 20):
                digest.update(part)
    except OSError:
        return "not readable"
    return digest.hexdigest()

"""What this package wrote, and with what content: nothing else, nor what was changed since, is replaced unasked."""

from __future__ import annotations

import contextlib
import hashlib
import os
from collections.abc import Iterator
from pathlib import Path

from ...errors import InvalidInput
from ...plain_data import mapping, text, texts
from ..spelling import short_list
from .json_files import load_json, save_json

#: File beside what commands and ``export`` wrote, with a hash of each.
MANIFEST = ".lostmotion-files.json"
_KIND = "written_files"


@contextlib.contextmanager
def replacing(*files: Path, force: bool = False) -> Iterator[None]:
    """Around the writing of files: those that are there must be this package's own, as it wrote them.

    Parameters
    ----------
    files : Path
        All that the block may write. What it has written, whole or interrupted, goes into the manifest of its folder.
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
        for folder in {file.parent for file in files}:
            after = {file: content_hash(file) for file in files if file.parent == folder}
            written = {file.name: found for file, found in after.items() if found != before[file]}
            if written:
                known = known_files(folder / MANIFEST, _KIND) or {}
                save_json(folder / MANIFEST, _KIND, {"files": dict(sorted({**known, **written}.items()))})


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
    """Whether a file may be replaced: it is not there, or its content is what the manifest says."""
    if not os.path.lexists(file):
        return True
    known = known_files(file.parent / MANIFEST, _KIND) or {}
    return known.get(file.name) == content_hash(file)


def known_files(manifest: Path, kind: str) -> dict[str, str | None] | None:
    """Names and hashes in a manifest; None where there is no manifest, or none that can be read."""
    try:
        files = load_json(manifest, kind)["files"]
        if isinstance(files, list):  # an older version listed names alone
            return dict.fromkeys(texts("files", files))
        return {name: text(name, found) for name, found in mapping("files", files).items()}
    except (InvalidInput, KeyError):
        return None


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

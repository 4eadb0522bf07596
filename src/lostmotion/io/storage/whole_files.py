"""Reading and writing whole files, with errors that a user can act on."""

from __future__ import annotations

import os
from pathlib import Path

from ...errors import InvalidInput


def read_bytes(path: Path) -> bytes:
    """The file's content; raises ``InvalidInput`` where it cannot be read."""
    try:
        return path.read_bytes()
    except FileNotFoundError:
        raise InvalidInput(str(path), "no such file", "a readable file", "Check the path.") from None
    except OSError as error:
        raise InvalidInput(
            str(path), str(error.strerror or error), "a readable file", "Check path and permissions."
        ) from None


def write_bytes(path: Path, content: bytes) -> None:
    """Write all or nothing: a sibling file, then a rename; raises ``InvalidInput`` where that fails."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        temporary.write_bytes(content)
        temporary.replace(path)
    except OSError as error:
        raise InvalidInput(
            str(path),
            str(error.strerror or error),
            "a place that can be written",
            "Check folder, rights, space.",
        ) from None
    finally:
        temporary.unlink(missing_ok=True)

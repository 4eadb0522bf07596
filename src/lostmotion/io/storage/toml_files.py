"""Reading a TOML, with an error that says what the file may be instead."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from ...errors import InvalidInput
from .whole_files import read_bytes


def read_toml(path: Path, expected: str) -> tuple[dict[str, Any], str]:
    """Content and text of a TOML; raises ``InvalidInput`` where it cannot be read or is none."""
    raw = read_bytes(path)
    try:
        text = raw.decode("utf-8-sig")
        return tomllib.loads(text), text
    except UnicodeDecodeError:
        got, remedy = "text that is not UTF-8", "Save it as UTF-8."
    except tomllib.TOMLDecodeError as error:
        got, remedy = f"broken TOML: {error}", "Put texts in quotes; see toml.io."
    if path.suffix.lower() != ".toml":
        got = f"a file with the ending {path.suffix!r} that is no TOML"
        remedy = (
            "A recording is named in a TOML: write one with lostmotion init, with "
            f'file = "{path.name}" in its [[recording]].'
        )
    raise InvalidInput(str(path), got, expected, remedy)

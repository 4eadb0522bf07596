"""Reading a TOML, with an error that says what the file may be instead."""

from __future__ import annotations

import codecs
import tomllib
from pathlib import Path
from typing import Any

from ...errors import InvalidInput
from .whole_files import read_bytes

#: Memory that a TOML takes once it is read, as a multiple of its text (calibrated as JSON's, with room).
_TAKES = 20.0
_MARKS = {
    codecs.BOM_UTF32_LE: "UTF-32",
    codecs.BOM_UTF32_BE: "UTF-32",
    codecs.BOM_UTF16_LE: "UTF-16",
    codecs.BOM_UTF16_BE: "UTF-16",
}
#: What to do, by a word of the parser's own message.
_REMEDIES = {
    "Cannot": "Keep one of the two.",
    "4300 digits": "No drive needs so long a number: shorten it.",
    "end of document": "If the file was cut off, copy it again; else complete its last line.",
}


def read_toml(path: Path, expected: str, otherwise: str = "") -> tuple[dict[str, Any], str]:
    """Content and text of a TOML; raises ``InvalidInput`` where it cannot be read or is none.

    ``otherwise`` is the remedy where another kind of file is named.
    """
    raw = read_bytes(path, takes=_TAKES)
    try:
        text = raw.decode("utf-8-sig")
        return tomllib.loads(text), text
    except UnicodeDecodeError:
        coding = next((name for mark, name in _MARKS.items() if raw.startswith(mark)), "")
        got = f"text in {coding}" if coding else "text that is not UTF-8"
        remedy = "Save it as UTF-8."
    except RecursionError:
        got, remedy = "broken TOML: hundreds of brackets in each other", "Close the brackets."
    except ValueError as error:
        got = f"broken TOML: {error}"
        remedy = "Numbers need a decimal point, texts and numbers with units quotes; see toml.io."
        for word, meant in _REMEDIES.items():
            remedy = meant if word in got else remedy
    if path.suffix.lower() != ".toml":
        got = f"a file with the ending {path.suffix!r} that is no TOML"
        remedy = otherwise or "Name the right file."
    raise InvalidInput(str(path), got, expected, remedy)

"""How a text table is written: its coding, its separator, its decimal sign."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import InvalidInput

_DECIMAL_COMMA = re.compile(r"(?<!\d)[-+]?\d+,\d+(?:[eE][-+]?\d+)?(?![\d,])", re.ASCII)
#: What counts as a number; Python's own ``float`` takes ``1_000`` and the digits of other scripts as well.
_NUMBER = re.compile(
    r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|\.\d+(?:e[-+]?\d+)?|nan|inf(?:inity)?)", re.ASCII | re.IGNORECASE
)
#: The part behind a decimal comma of 1,05: no whole number is written so.
_FRACTION = re.compile(r"0\d+", re.ASCII)
#: Longest field that counts as a number, characters (option): the time to read one grows with the square.
LONGEST = 100
#: Characters of a line that are searched for a decimal comma (option: some hundred fields).
LONGEST_LINE = 5000
#: Files that are often taken for a table, by their first bytes (numerics: the formats' published marks).
FOREIGN = {
    b"\xd0\xcf\x11\xe0": "an old spreadsheet",
    b"\x1f\x8b": "a gzip archive",
    b"MDF ": "a measurement file in MDF",
    b"TDSm": "a measurement file in TDMS",
    b"%PDF": "a PDF",
    b"\x89PNG": "a picture",
    b"\x89HDF": "an HDF5 file",
}
#: Lines that are looked at to find the dialect (option).
SAMPLE = 200


def decode(raw: bytes, where: str) -> str:
    """Text of a file: UTF-8 or UTF-16 by its byte order mark, else UTF-8, else Windows-1252 (µ, °, ²)."""
    if raw.startswith((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)):
        raise _wide(where, "UTF-32")
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", errors="replace")
    if coding := _coding(raw[:8192]):
        raise _wide(where, f"{coding} without a byte order mark")
    kind = next((name for mark, name in FOREIGN.items() if raw.startswith(mark)), "")
    if kind or b"\0" in raw[:8192]:
        whole = raw[:8192].count(b"\0") > 0.05 * len(raw[:8192]) or kind
        raise InvalidInput(
            where,
            kind or ("a binary file" if whole else "a text with zero bytes in it"),
            "a text table (CSV), a MATLAB .mat or an .npz file",
            "Export it as one of these." if whole else "It was not written whole: copy or export it again.",
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _wide(where: str, coding: str) -> InvalidInput:
    return InvalidInput(
        where, f"text in {coding}", "text in UTF-8", "Save it again as UTF-8 (in Excel: CSV UTF-8)."
    )


def _coding(raw: bytes) -> str:
    """The coding of ASCII text in which every character takes two or four bytes, "" for anything else."""
    for coding, width, places in (("UTF-32", 4, (0, 3)), ("UTF-16", 2, (0, 1))):
        for place in places:
            rest = raw[: len(raw) // width * width]
            characters = rest[place::width]
            zeros = rest.count(0) == len(rest) - len(characters)
            if characters and zeros and b"\0" not in characters:
                return coding
    return ""


@dataclass(frozen=True)
class Dialect:
    """Separator (None: blanks) and whether the decimal sign is a comma."""

    separator: str | None
    decimal_comma: bool

    def split(self, line: str) -> list[str]:
        """Fields of one line, quotes removed, trailing separator dropped."""
        if self.separator is None:
            return line.split()
        fields = [line]
        if '"' not in line:
            fields = line.split(self.separator)
        else:
            try:
                fields = next(csv.reader([line], delimiter=self.separator))
            except csv.Error:  # a field of more than 131072 characters
                fields = line.split(self.separator)
        fields = [field.strip() for field in fields]
        return fields[:-1] if fields and fields[-1] == "" else fields

    def number(self, text: str) -> float | None:
        """The number that a field holds, None if it holds none."""
        text = text.replace(",", ".") if self.decimal_comma else text
        return float(text) if len(text) <= LONGEST and _NUMBER.fullmatch(text.strip()) else None

    def is_data(self, line: str) -> bool:
        """Whether more than half of the fields that are not empty are numbers."""
        fields = [field for field in self.split(line) if field]
        return 2 * sum(self.number(field) is not None for field in fields) > len(fields)


def find_dialect(lines: Sequence[str]) -> Dialect:
    """The separator that splits the sampled lines into most columns of numbers; in a tie ``,`` comes last.

    Where ``;``, tab or blanks separate, a comma inside numbers is the decimal sign.
    """
    sample = lines[-SAMPLE:]
    best, best_score = Dialect(",", False), 0.0
    for separator in (";", "\t", None, ","):
        for comma in (False, True) if separator != "," else (False,):
            if comma and not any(_DECIMAL_COMMA.search(line, 0, LONGEST_LINE) for line in sample):
                continue
            dialect = Dialect(separator, comma)
            counts = [sum(dialect.number(f) is not None for f in dialect.split(line)) for line in sample]
            score = float(np.median(counts)) if counts else 0.0
            if score > best_score:
                best, best_score = dialect, score
    return best


def check_decimal_commas(lines: Sequence[str], names: int, where: str) -> None:
    """Refuse commas that separate columns and decimals alike: no reader can tell 0,5 from two columns.

    Seen by fewer names than fields (``names`` is 0 without a header), or by fields such as 05, and no decimal point.
    """
    sample = lines[:SAMPLE]
    fields = [line.split(",") for line in sample if '"' not in line]
    if any("." in line for line in sample) or not fields:
        return
    width = float(np.median([len(row) for row in fields]))
    fractions = sum(any(_FRACTION.fullmatch(field.strip()) for field in row[1:]) for row in fields)
    if 2 <= names < width <= 2 * names or (not names and fractions > 0.1 * len(fields)):
        raise InvalidInput(
            where,
            f"a comma between columns and as the decimal sign, too: {sample[0][:60]!r}",
            "a decimal point, or ; or tabs between the columns",
            "Export it again so: 0,5 may as well be two columns.",
        )

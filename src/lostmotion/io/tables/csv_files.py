"""Text tables: with or without header, any usual separator, decimal point or comma."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput, Problem
from ...recording import SIGNAL_UNITS
from ..spelling import short_list, split_unit, suggestion
from .columns import Column
from .units import is_unit

COMMENT_MARKS = ("#", "%", "//")
_DECIMAL_COMMA = re.compile(r"(?<!\d)[-+]?\d+,\d+(?:[eE][-+]?\d+)?(?![\d,])")
_TIME_NAMES = ("time", "t")


def decode(raw: bytes, where: str) -> str:
    """Text of a file: UTF-8 or UTF-16 by its byte order mark, else UTF-8, else Windows-1252 (µ, °, ²)."""
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", errors="replace")
    if b"\0" in raw[:8192]:
        raise InvalidInput(
            where,
            "a binary file",
            "a text table (CSV), a MATLAB .mat or an .npz file",
            "Check the file's ending.",
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


@dataclass(frozen=True)
class Dialect:
    """Separator (None: blanks) and whether the decimal sign is a comma."""

    separator: str | None
    decimal_comma: bool

    def split(self, line: str) -> list[str]:
        """Fields of one line, quotes removed, trailing separator dropped."""
        if self.separator is None:
            return line.split()
        fields = [field.strip() for field in next(csv.reader([line], delimiter=self.separator))]
        return fields[:-1] if fields and fields[-1] == "" else fields

    def number(self, text: str) -> float | None:
        """The number that a field holds, None if it holds none."""
        try:
            return float(text.replace(",", ".") if self.decimal_comma else text)
        except ValueError:
            return None

    def is_data(self, line: str) -> bool:
        """Whether more than half of the fields that are not empty are numbers."""
        fields = [field for field in self.split(line) if field]
        return 2 * sum(self.number(field) is not None for field in fields) > len(fields)


def find_dialect(lines: Sequence[str]) -> Dialect:
    """The separator that splits the sampled lines into most columns of numbers; in a tie ``,`` comes last.

    Where ``;``, tab or blanks separate, a comma inside numbers is the decimal sign.
    """
    sample = lines[-200:]
    best, best_score = Dialect(",", False), 0.0
    for separator in (";", "\t", None, ","):
        for comma in (False, True) if separator != "," else (False,):
            if comma and not any(_DECIMAL_COMMA.search(line) for line in sample):
                continue
            dialect = Dialect(separator, comma)
            counts = [sum(dialect.number(f) is not None for f in dialect.split(line)) for line in sample]
            score = float(np.median(counts)) if counts else 0.0
            if score > best_score:
                best, best_score = dialect, score
    return best


@dataclass(frozen=True, eq=False)
class CsvTable:
    """The lines of a text table that hold data, its header, and how to read it."""

    where: str
    dialect: Dialect
    header: tuple[str, ...]
    units: tuple[str, ...]
    lines: Sequence[str]
    line_numbers: NDArray[np.int64]
    width: int

    def index(self, key: str | int, where: str) -> int:
        """Position of a column given by number (from 0) or header text, with or without its unit."""
        if isinstance(key, int):
            if 0 <= key < self.width:
                return key
            raise InvalidInput(
                where, f"column {key}", f"a number from 0 to {self.width - 1}", "Columns are counted from 0."
            )
        for names in (self.header, tuple(split_unit(name)[0] for name in self.header)):
            found = [i for i, name in enumerate(names) if name == key]
            if len(found) > 1:
                raise InvalidInput(
                    where, f"{len(found)} columns named {key!r}", "one", f"Give its number, one of {found}."
                )
            if found:
                return found[0]
        if not self.header:
            raise InvalidInput(
                where,
                f"column {key!r}",
                f"a number from 0 to {self.width - 1}: the file has no header",
                "Use it.",
            )
        raise InvalidInput(
            where, f"no column {key!r}", "one of " + short_list(self.header), suggestion(key, self.header)
        )

    def columns(self, keys: dict[str, str | int]) -> tuple[dict[str, Column], list[Problem]]:
        problems: list[Problem] = []
        places: dict[str, int] = {}
        for name, key in keys.items():
            try:
                places[name] = self.index(key, f"{self.where}, {name}")
            except InvalidInput as error:
                problems.append(error.problem)
        ragged = self._ragged_lines()
        problems += ragged
        if not places or ragged:
            return {}, problems
        wanted = sorted(set(places.values()))
        data, text_problems = self._numbers(wanted)
        problems += text_problems
        found = {
            name: Column(
                data[:, wanted.index(i)],
                self.units[i] if self.units else "",
                f"column {self.header[i]!r}" if self.header else f"column {i}",
                self.line_numbers,
            )
            for name, i in places.items()
            if data.size
        }
        return found, problems

    def known_signals(self) -> dict[str, str | int]:
        names = [split_unit(name)[0] for name in self.header]
        found: dict[str, str | int] = {name: i for i, name in enumerate(names) if name in SIGNAL_UNITS}
        times: list[str | int] = [i for i, name in enumerate(names) if name.lower() in _TIME_NAMES]
        return {**found, "time": times[0]} if times else found

    def time_of(self, key: str | int) -> str | int | None:
        return self.known_signals().get("time")

    def _ragged_lines(self) -> list[Problem]:
        """Lines with too few or too many fields; the last one is named as cut off."""
        separator = self.dialect.separator
        if separator is None:
            counts = np.array([len(line.split()) for line in self.lines])
        else:
            counts = np.array([line.count(separator) for line in self.lines])
            trailing = np.array([line.endswith(separator) for line in self.lines])
            counts = counts + 1 - trailing
            quoted = np.array(['"' in line for line in self.lines])
            for i in np.flatnonzero(quoted & (counts != self.width)).tolist():
                counts[i] = len(self.dialect.split(self.lines[i]))
        bad = np.flatnonzero(counts != self.width)
        if not bad.size:
            return []
        cut = bad.size == 1 and bad[0] == len(self.lines) - 1 and counts[bad[0]] < self.width
        rest = f" (and {bad.size - 1} more lines)" if bad.size > 1 else ""
        return [
            Problem(
                "error",
                f"{self.where}, line {self.line_numbers[bad[0]]}",
                f"{counts[bad[0]]} fields{rest}",
                f"{self.width} fields in every line",
                "The file seems cut off: copy it again, or delete the last line."
                if cut
                else "Check the separator and the decimal sign, or delete these lines.",
            )
        ]

    def _numbers(self, wanted: list[int]) -> tuple[NDArray[np.float64], list[Problem]]:
        lines = self.lines
        if self.dialect.decimal_comma:
            lines = "\n".join(lines).replace(",", ".").split("\n")
        try:
            separator = self.dialect.separator
            data = np.loadtxt(
                lines, delimiter=separator, usecols=wanted, comments=None, quotechar='"', ndmin=2
            )
            return data, []
        except ValueError:
            return np.empty((0, len(wanted))), self._texts(wanted)

    def _texts(self, wanted: list[int]) -> list[Problem]:
        """The fields that are no numbers: only looked for after the fast reading has failed."""
        bad: dict[int, list[tuple[int, str]]] = {}
        for line, number in zip(self.lines, self.line_numbers, strict=True):
            fields = self.dialect.split(line)
            for i in wanted:
                text = fields[i] if i < len(fields) else ""
                if self.dialect.number(text) is None:
                    bad.setdefault(i, []).append((int(number), text))
        return [
            Problem(
                "error",
                f"{self.where}, {f'column {self.header[i]!r}' if self.header else f'column {i}'}",
                (f"text {places[0][1]!r}" if places[0][1] else "an empty field")
                + f" in line {short_list((n for n, _ in places), 5)}",
                "a number in every line",
                "Fill or delete these lines.",
            )
            for i, places in bad.items()
        ]


def _header(
    head: list[str], dialect: Dialect, width: int, where: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units from the lines above the data: the last ones that have as many fields as the data."""
    rows = [fields for fields in map(dialect.split, head) if len(fields) == width]
    if not rows:
        if head:
            raise InvalidInput(
                where,
                f"a header {head[-1][:60]!r} that does not have {width} fields as the data do",
                "one name for each column",
                "Give every column a name, separated like the data; mark other lines as comments with #.",
            )
        return (), ()
    unit_row = len(rows) > 1 and all(is_unit(f.strip("[]() ")) for f in rows[-1] if f.strip("[]() -"))
    names = rows[-2] if unit_row else rows[-1]
    if unit_row:
        return tuple(names), tuple(field.strip("[]() ") for field in rows[-1])
    return tuple(names), tuple(split_unit(name)[1] for name in names)


def read_csv(path: Path, raw: bytes) -> CsvTable:
    """Find header, separator and decimal sign of a text table; numbers are read when columns are asked for.

    Blank lines and lines that begin with ``#``, ``%`` or ``//`` are left out.

    Raises
    ------
    InvalidInput
        If the file is binary, empty, or holds no numbers.
    """
    where = str(path)
    lines = decode(raw, where).splitlines()
    stripped = [line.strip(" \r\n\f\v") for line in lines]
    keep = [i for i, line in enumerate(stripped) if line.strip() and not line.startswith(COMMENT_MARKS)]
    if not keep:
        raise InvalidInput(where, "an empty file", "a table of numbers", "Check the path and the recording.")
    texts = [stripped[i] for i in keep]
    dialect = find_dialect(texts)
    start = next((i for i, line in enumerate(texts) if dialect.is_data(line)), None)
    if start is None:
        raise InvalidInput(
            where,
            f"no line of numbers; the first line is {texts[0][:60]!r}",
            "columns of numbers separated by ; , tab or blanks",
            "Check the separator and the decimal sign.",
        )
    body = texts[start:]
    width = int(np.median([len(dialect.split(line)) for line in body[:200]]))
    header, units = _header(texts[:start], dialect, width, where)
    return CsvTable(where, dialect, header, units, body, np.array(keep[start:]) + 1, width)

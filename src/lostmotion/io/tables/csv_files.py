"""Text tables: with or without header, any usual separator, decimal point or comma."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput, Problem
from ...memory import check_memory
from ...plain_data import shown
from ...recording import unit_of
from ..spelling import short_list, split_unit, suggestion
from .columns import Column
from .dialects import LONGEST, Dialect, check_decimal_commas, decode, find_dialect
from .units import is_unit

#: Bytes of memory that reading takes for each byte and for each line (calibrated on lines of 4 to 50
#: bytes).
PER_BYTE, PER_LINE = 4.0, 150.0
COMMENT_MARKS = ("#", "%", "//")
_TIME_NAMES = ("time", "t", "time_s", "t_s", "zeit", "timestamp")
#: A date, or a time of the day.
_DATE = re.compile(r"\d[-/.]\d+[-/.]\d|\d:\d\d", re.ASCII)
_DATES = "Export seconds instead of dates, or give time = { sample_time = ... }."


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
        exact = [i for i, name in enumerate(self.header) if name == key and split_unit(name)[1]]
        found = exact or [i for i, name in enumerate(self.header) if key in (name, split_unit(name)[0])]
        if len(found) > 1:
            raise InvalidInput(
                where, f"{len(found)} columns named {shown(key)}", "one", f"Give its number, one of {found}."
            )
        if found:
            return found[0]
        if not self.header:
            raise InvalidInput(
                where,
                f"column {shown(key)}",
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
                f"column {shown(self.header[i])}" if self.header else f"column {i}",
                self.line_numbers,
            )
            for name, i in places.items()
            if data.size
        }
        return found, problems

    def known_signals(self) -> dict[str, str | int]:
        names = [split_unit(name)[0] for name in self.header]
        found: dict[str, str | int] = {name: name for name in names if unit_of(name)}
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
        if max(map(len, lines)) > LONGEST * self.width:
            return self._one_by_one(wanted)
        if self.dialect.decimal_comma:
            if mixed := self._mixed_signs(wanted):
                return np.empty((0, len(wanted))), mixed
            lines = "\n".join(lines).replace(",", ".").split("\n")
        try:
            separator = self.dialect.separator
            data = np.loadtxt(
                lines, delimiter=separator, usecols=wanted, comments=None, quotechar='"', ndmin=2
            )
        except ValueError:
            return self._one_by_one(wanted)
        # A quote that is not closed goes on in the next line.
        return (data, []) if len(data) == len(lines) else self._one_by_one(wanted)

    def _mixed_signs(self, wanted: list[int]) -> list[Problem]:
        """Columns with a decimal comma in some lines and a point in others: 1.234 may be a thousand there."""
        points = [
            (line, int(number))
            for line, number in zip(self.lines, self.line_numbers, strict=True)
            if "." in line
        ]
        problems = []
        for i in wanted if points else ():
            found = next(((text, n) for line, n in points if "." in (text := self._field(line, i))), None)
            if found and any("," in self._field(line, i) for line in self.lines):
                name = f"column {shown(self.header[i])}" if self.header else f"column {i}"
                got = f"{shown(found[0])} in line {found[1]}, and a decimal comma in other lines"
                remedy = "Export it again with one decimal sign and without a sign between thousands."
                problems.append(Problem.error(f"{self.where}, {name}", got, "one decimal sign", remedy))
        return problems

    def _field(self, line: str, i: int) -> str:
        fields = self.dialect.split(line)
        return fields[i] if i < len(fields) else ""

    def _one_by_one(self, wanted: list[int]) -> tuple[NDArray[np.float64], list[Problem]]:
        """The numbers, or all fields that are none: slow, and only after the fast reading has failed."""
        data = np.empty((len(self.lines), len(wanted)))
        bad: dict[int, list[tuple[int, str]]] = {}
        for row, (line, number) in enumerate(zip(self.lines, self.line_numbers, strict=True)):
            fields = self.dialect.split(line)
            for column, i in enumerate(wanted):
                text = fields[i] if i < len(fields) else ""
                value = self.dialect.number(text)
                if value is None:
                    bad.setdefault(i, []).append((int(number), text))
                else:
                    data[row, column] = value
        return (np.empty((0, len(wanted))) if bad else data), [
            Problem(
                "error",
                f"{self.where}, {f'column {shown(self.header[i])}' if self.header else f'column {i}'}",
                (f"text {shown(places[0][1])}" if places[0][1] else "an empty field")
                + f" in line {short_list((n for n, _ in places), 5)}",
                "a number in every line: digits, a decimal sign, perhaps an exponent",
                _DATES if _DATE.search(places[0][1][:40]) else "Fill or delete these lines.",
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
    count = raw.count(b"\n") + 1
    needed = PER_BYTE * len(raw) + PER_LINE * count
    check_memory(where, f"a text of {count} lines", needed, "Cut the recording, or leave columns out.")
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
            f"no line of numbers; the first line is {texts[0][:60]!r}, the last {texts[-1][:60]!r}",
            "columns of numbers such as -1.5e-3, separated by ; , tab or blanks",
            "Check the separator, the decimal sign and the exponent.",
        )
    body = texts[start:]
    width = int(np.median([len(dialect.split(line)) for line in body[:200]]))
    if dialect.separator == ",":
        check_decimal_commas(body, len(dialect.split(texts[start - 1])) if start else 0, where)
    header, units = _header(texts[:start], dialect, width, where)
    return CsvTable(where, dialect, header, units, body, np.array(keep[start:]) + 1, width)

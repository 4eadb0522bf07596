"""A hundred slips in TOML and CSV, each refused with the cause and a remedy."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InputProblems, Problem
from lostmotion.io import find_problems, read_recording

HEAD = "time [s],speed_motor [rad/s],torque_motor [Nm]"
TIME = 1e-3 * np.arange(150)
ROWS = [f"{t:.3f},{20 * np.sin(30 * t):.6f},{3 * np.cos(30 * t):.6f}" for t in TIME]
RECORDING = '[[recording]]\nfile = "rig.csv"\n'

#: Lines of one table of the TOML, and what the error says; "/" begins another line.
NAMEPLATE = """
inertia_motor = nan                  | a finite number in kg m2
stiffness = inf                      | a finite number in Nm/rad
backlash = -0.01                     | Check the sign
stiffness = 1e300                    | Check the unit and the power of ten
inertia_motor = "3 deg"              | a unit of kg m2
backlash = "3 Nm"                    | a unit of rad
backlash = "1 furlong"               | unknown unit 'furlong'
backlash = [1, 2]                    | [1, 2], expected a number in rad
backlash = 1979-05-27                | a number in rad
lag = true                           | True, expected a number in s
lag = "0,3 ms"                       | Write 0.5 for a half, not 0,5
lag = "ms"                           | then the unit
lag = "1 2 ms"                       | unknown unit '2 ms'
lag = ""                             | '', expected a number
lag = { value = 1 }                  | {'value': 1}
lag = 1e-3 / lag = 1e-3              | Cannot overwrite a value
lagg = 1e-3                          | Did you mean 'lag'
"""
LAW = """
torque_limit = -5                    | Check the sign
torque_limit = "5 rad"               | a unit of Nm
torque_limit = inf                   | a finite number in Nm
torque_limit = 1e300                 | 1e-09 to 1e+12 Nm
sample_time = 0                      | a positive number
sample_time = 1e300                  | 1e-07 to 10 s
sample_time = 1e-300                 | Check the unit and the power of ten
kp = inf / ki = 1                    | inf, expected a finite number
kp = 1e300 / ki = 1                  | at most 1e+12 Nm s/rad
kp = 1 / ki = nan                    | nan, expected a finite number
kp = true / ki = 1                   | True, expected a finite number
poles = [nan, -1, -1]                | nan, expected three numbers
poles = ["a", "b", "c"]              | Write poles = [-400, -400, -400]
poles = [0, -1, -1]                  | left of zero
poles = [[-1], [-1], [-1]]           | three numbers in 1/s
kd = 1                               | unknown key 'kd'
"""
RUN = """
seed = "1"                           | a whole number, without quotes
seed = true                          | a whole number
seed = 9223372036854775808           | less than 9223372036854775808
sede = 1                             | Did you mean 'seed'
"""
OF_A_RECORDING = """
use = "train"                        | identify, validate
use = ["identify"]                   | identify, validate
window = [0.05, 0.05]                | Give a later stop
window = [0.1, 0.05]                 | Swap them
window = [100, 200]                  | between 0 and 0.149 s
window = [0, inf]                    | a finite number in s
window = [0, 1, 2]                   | a list of 3
window = ["0 s", "1 rad"]            | a unit of s
window = { start = 0, stop = 1 }     | [start, stop], s
window = [0, 0.01]                   | 10 samples, expected at least 100
resample = "often"                   | 'often', expected a number in s
resample = 0                         | such as "0.1 ms"
resample = "1 s"                     | Choose a shorter one
resample = [1]                       | [1], expected a number
resample = 1e-12                     | Choose a longer step
time = "clock"                       | no column 'clock'
time = -1                            | counted from 0
time = 1.5                           | 1.5, expected a column
time = {}                            | Give at least the column
time = { column = 0, sample_time = 1 } | sample_time alone, or a column
time = { column = 0, unit = "rad" }  | a unit of s
time = { column = 0, unit = "ns", scale = 1 } | a sample time of 1e-12 s
time = { sample_time = -1 }          | more than 0 s
time = { sample_time = "fast" }      | a number in s
time = { sample_time = "1 s" }       | Leave time out if the file is right
time = 1                             | a unit of s
channels.speed = 1                   | Did you mean 'speed_load' or 'speed_motor'
channels = [1, 2]                    | Give one entry for each signal
channels.speed_motor = -1            | a number from 0 to 2
channels.speed_motor = 99            | a number from 0 to 2
channels.speed_motor = "spead"       | no column 'spead'
channels.speed_motor = {}            | Give at least the column
channels.speed_motor = true          | Give at least the column
channels.speed_motor = { column = 1, sign = 0 }      | sign 0, expected 1 or -1
channels.speed_motor = { column = 1, sign = "-" }    | sign '-', expected 1 or -1
channels.speed_motor = { column = 1, scale = 0 }     | Check the power of ten
channels.speed_motor = { column = 1, scale = nan }   | nan, expected a finite number
channels.speed_motor = { column = 1, scale = "2" }   | '2', expected a finite number
channels.speed_motor = { column = 1, offset = inf }  | inf, expected a finite number
channels.speed_motor = { column = 1, unit = 3 }      | text such as "rpm"
channels.speed_motor = { column = 1, unit = "furlong" } | unknown unit 'furlong'
channels.speed_motor = { column = 1, unit = "rpm" }  | add scale = 1
channels.torque_motor = { column = 2, unit = "A" }   | the torque constant
channels.angle_motor = { column = 1, unit = "counts" } | Add counts_per_rev
channels.angle_motor = { column = 1, unit = "counts", counts_per_rev = -1 } | Add counts_per_rev
channels.speed_motor = 1 / channels.speed_load = 1   | the same numbers for both
channels.speed_motor = 0                             | a unit of rad/s
speed_from_counts = "yes"                            | true or false, without quotes
speed_from_count = true                              | Did you mean 'speed_from_counts'
"""
#: Whole TOMLs.
WHOLE = """
# nothing                            | Add a [[recording]]
[nameplate] / lag = 1e-3             | Add a [[recording]]
law = [] / [[recording]] / file = "rig.csv" | a table [law]
run = "x" / [[recording]] / file = "rig.csv" | a table [run]
[[nameplate]] / lag = 1 / [[recording]] / file = "rig.csv" | a table [nameplate]
[[recording]] / file = ""            | the name of a file
[[recording]] / file = "."           | Name the file in it
[[recording]] / file = 1             | a text in quotes
[[recording]] / file = ["a", "b"]    | a text in quotes
[[recording]] / file = "ftp://x.y/z" | Download it first
[[recording]] / file = "~no-such-user/a"| Write the path out
[[recording] / file = "rig.csv"      | broken TOML: Expected ']]'
[[recording]] / file: "rig.csv"      | broken TOML: Expected '='
[recording] / file = rig.csv         | broken TOML: Invalid value
{"recording": [{"file": "rig.csv"}]} | broken TOML: Invalid statement
"""


def rows_of(table: str, before: str = "", after: str = "") -> Iterator[tuple[str, str]]:
    for line in table.strip().splitlines():
        written, _, said = line.rpartition("|")
        yield before + written.strip().replace(" / ", "\n") + "\n" + after, said.strip()


TOMLS = [
    *rows_of(NAMEPLATE, "[nameplate]\n", RECORDING),
    *rows_of(LAW, f"{RECORDING}[law]\n"),
    *rows_of(RUN, f"{RECORDING}[run]\n"),
    *rows_of(OF_A_RECORDING, RECORDING),
    *rows_of(WHOLE),
]


def assert_said(problems: tuple[Problem, ...], words: str) -> None:
    """The words stand in one of the errors, all of which say everything."""
    errors = [p for p in problems if p.severity == "error"]
    assert all(p.where and p.got and p.expected and p.remedy for p in errors)
    assert any(words in str(p) for p in errors), "\n".join(map(str, problems))


@pytest.mark.parametrize(("text", "words"), TOMLS)
def test_slips_in_a_toml(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "rig.csv").write_text("\n".join([HEAD, *ROWS]) + "\n")
    (tmp_path / "rig.toml").write_text(text)
    assert_said(find_problems(tmp_path / "rig.toml"), words)


def cell(text: str) -> Callable[[list[str]], list[str]]:
    """Another speed in the eighth row."""
    return lambda rows: [*rows[:7], rows[7].split(",")[0] + f",{text},0", *rows[8:]]


def same(rows: list[str]) -> list[str]:
    return rows


CSVS = [
    ("", lambda rows: [], "an empty file"),
    ("\n\n", lambda rows: [], "an empty file"),
    (HEAD, lambda rows: [], "no line of numbers"),
    (HEAD, lambda rows: rows[:1], "1 samples, expected at least 100"),
    (HEAD, lambda rows: rows[:90], "90 samples, expected at least 100"),
    (HEAD, lambda rows: [f"x{row}" for row in rows], "text 'x0.000' in line 2, 3, 4"),
    (HEAD, lambda rows: [*rows[:50], "0.050,1", *rows[51:]], "line 52: got 2 fields, expected 3"),
    (HEAD, lambda rows: [*rows[:50], rows[50] + ",1", *rows[51:]], "line 52: got 4 fields"),
    (HEAD, lambda rows: [*rows[:149], "0.149,1"], "The file seems cut off"),
    (HEAD, lambda rows: rows[::-1], "strictly increasing times"),
    (HEAD, lambda rows: [*rows[:50], *rows[49:]], "1 such steps"),
    (HEAD, lambda rows: [*rows[1::2], *rows[::2]], "sort the rows"),
    (HEAD, lambda rows: [row.split(",")[0] + ",nan,nan" for row in rows], "150 values"),
    (HEAD, lambda rows: ["0" + row[5:] for row in rows], "149 such steps"),
    (HEAD, lambda rows: ["-" + row for row in rows], "strictly increasing"),
    (HEAD, lambda rows: [*rows[:20], *rows[40:]], "choose a window without gaps"),
    (HEAD, lambda rows: [f"2024-05-01 12:00:0{row}" for row in rows], "Export seconds instead of dates"),
    (HEAD, lambda rows: [f"12:00:0{row}" for row in rows], "Export seconds instead of dates"),
    (HEAD, lambda rows: [*rows[:50], "<<<<<<< HEAD", *rows[50:]], "got 1 fields"),
    (HEAD, lambda rows: [*rows[:7], rows[7].replace(",", ";"), *rows[8:]], "line 9: got 1 fields"),
    (HEAD, lambda rows: [*rows[:7], rows[7] + "\0", *rows[8:]], "zero bytes"),
    (HEAD, lambda rows: [*rows[:7], '"' + rows[7], *rows[8:]], "text '0.007"),
    (HEAD, cell("inf"), "line 9"),
    (HEAD, cell("0x10"), "text '0x10' in line 9"),
    (HEAD, cell("1/2"), "text '1/2' in line 9"),
    (HEAD, cell("50%"), "text '50%' in line 9"),
    (HEAD, cell("1'000"), "in line 9"),
    (HEAD, cell("--"), "text '--' in line 9"),
    (HEAD, cell("#DIV/0!"), "text '#DIV/0!' in line 9"),
    (HEAD, cell("NULL"), "text 'NULL' in line 9"),
    (HEAD, cell("1e999"), "NaN or infinity in line 9"),
    (HEAD, cell("1" * 100_000), "in line 9"),
    ("<html>", lambda rows: [], "the first line is '<html>'"),
    ("%PDF-1.4", lambda rows: [], "a PDF"),
    ("time [parsec],speed_motor,torque_motor", same, "unknown unit 'parsec'"),
    ("time [s],speed_motor [Nm],torque_motor", same, "a unit of rad/s"),
    ("time [s],speed_motor,speed_motor", same, "Give its number, one of [1, 2]"),
    ("a,b,c", same, "Say which column is which"),
    ("x,speed_motor,torque_motor", same, "no time"),
    ("time,speed_motor,torque_motor", lambda rows: [str(i) + "000000" + r[5:] for i, r in enumerate(rows)],
     "a sample time of 1e+06 s"),
    (HEAD, lambda rows: [f"{1e15 + i / 1000!r}" + r[5:] for i, r in enumerate(rows)], "strictly increasing"),
]  # fmt: skip


@pytest.mark.parametrize(("head", "change", "words"), CSVS)
def test_slips_in_a_csv(
    tmp_path: Path, head: str, change: Callable[[list[str]], list[str]], words: str
) -> None:
    (tmp_path / "rig.csv").write_text("\n".join([head, *change(ROWS)]))
    with pytest.raises(InputProblems) as caught:
        read_recording(tmp_path / "rig.csv")
    assert_said(caught.value.problems, words)


def test_what_the_slips_are_made_of_is_sound(tmp_path: Path) -> None:
    """Else the tables above would prove nothing."""
    (tmp_path / "rig.csv").write_text("\n".join([HEAD, *ROWS]))
    assert len(read_recording(tmp_path / "rig.csv")) == 150
    (tmp_path / "rig.toml").write_text(RECORDING)
    assert {p.severity for p in find_problems(tmp_path / "rig.toml")} == {"warning"}
    assert len(TOMLS) + len(CSVS) > 140


def test_the_line_of_a_slip_is_named(tmp_path: Path) -> None:
    (tmp_path / "rig.csv").write_text("\n".join([HEAD, *ROWS]))
    (tmp_path / "rig.toml").write_text(RECORDING + "channels.speed_motor = { column = 1, scale = 0 }\n")
    (problem,) = (p for p in find_problems(tmp_path / "rig.toml") if p.severity == "error")
    assert re.search(r"rig\.toml, line 3, recording\[0\]\.channels\.speed_motor\.scale$", problem.where)

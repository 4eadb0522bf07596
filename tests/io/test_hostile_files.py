"""Files that once hung a reader, ended it, took the machine's memory, or passed: names, pipes, codings, archives."""

from __future__ import annotations

import io
import os
import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import io as files
from lostmotion.errors import InputProblems, InvalidInput, LostMotionError

HEAD = "time [s],speed_motor [rad/s],torque_motor [Nm]"
TIME = 1e-3 * np.arange(150)
SPEED = 20.0 * np.sin(30.0 * TIME)
ROWS = [f"{t:.3f},{w:.6f},{3.0 * np.cos(30.0 * t):.6f}" for t, w in zip(TIME, SPEED, strict=True)]
READERS: list[Callable[[Any], object]] = [
    files.read_recording, lm.load_recording, lm.load_law, lm.load_drivetrain, files.read_configuration,
    lambda path: files.load_json(path, "results"), lambda path: files.read_torsional_model(path, path),
]  # fmt: skip


def law() -> lm.DiscreteSystem:
    return lm.controllers.pi(dt=1e-3)


def recording() -> lm.Recording:
    return lm.Recording(TIME, {"speed_motor": SPEED})


WRITERS: list[Callable[[Any], object]] = [
    lambda path: lm.save_law(law(), path),
    lambda path: lm.save_recording(recording(), path),
    lambda path: lm.save_drivetrain(lm.Drivetrain((1.0,)), path),
    lambda path: files.save_json(path, "results", {}),
    lambda path: files.write_csv(path, recording()),
    lambda path: lm.export.c(law(), path),
]


def table(change: Callable[[list[str]], list[str]] = lambda rows: rows) -> str:
    return "\n".join([HEAD, *change(ROWS)]) + "\n"


@pytest.mark.parametrize("name", ["a\0b", "n" * 5000, "n" * 300 + ".npz"], ids=["NUL", "5000", "300"])
@pytest.mark.parametrize("use", [*READERS, *WRITERS], ids=range(len(READERS) + len(WRITERS)))
def test_a_name_that_no_file_can_have(tmp_path: Path, use: Callable[[Any], object], name: str) -> None:
    with pytest.raises(LostMotionError) as caught:
        use(str(tmp_path / name))
    assert "name" in str(caught.value) and len(str(caught.value)) < 3000
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a\\u0000b", "n" * 5000])
def test_such_a_name_in_a_toml_is_one_problem(tmp_path: Path, name: str) -> None:
    (tmp_path / "rig.toml").write_text(f'[[recording]]\nfile = "{name}"\n')
    (problem,) = (p for p in files.find_problems(tmp_path / "rig.toml") if p.severity == "error")
    assert "name" in problem.got


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes as on POSIX systems")
@pytest.mark.parametrize("ending", ["csv", "mat", "npz", "toml", "json"])
@pytest.mark.parametrize("read", READERS, ids=range(len(READERS)))
def test_a_pipe_is_not_waited_for(tmp_path: Path, read: Callable[[Any], object], ending: str) -> None:
    os.mkfifo(tmp_path / f"rig.{ending}")
    with pytest.raises(LostMotionError, match=r"a pipe.*Write what comes out of it to a file first"):
        read(tmp_path / f"rig.{ending}")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="devices as on POSIX systems")
def test_a_device_is_no_file() -> None:
    with pytest.raises(InputProblems, match="a device"):
        files.read_recording("/dev/zero")


@pytest.mark.parametrize("cell", ["1_000", "١٢", "½", "１２"])
def test_what_python_takes_for_a_number_is_none(tmp_path: Path, cell: str) -> None:
    (tmp_path / "rig.csv").write_text(
        table(lambda rows: [*rows[:7], f"0.007,{cell},0", *rows[8:]]), encoding="utf-8"
    )
    with pytest.raises(InputProblems, match=f"text '{cell}' in line 9"):
        files.read_recording(tmp_path / "rig.csv")


@pytest.mark.parametrize("coding", ["utf-32", "utf-32-le", "utf-32-be", "utf-16-le", "utf-16-be"])
def test_the_coding_of_a_text_is_named(tmp_path: Path, coding: str) -> None:
    (tmp_path / "rig.csv").write_bytes(table().encode(coding))
    with pytest.raises(InputProblems, match=f"UTF-{coding[4:6]}.*Save it again as UTF-8"):
        files.read_recording(tmp_path / "rig.csv")


def test_a_toml_in_utf_32_is_named(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text('[[recording]]\nfile = "rig.csv"\n', encoding="utf-32")
    with pytest.raises(InputProblems, match=r"text in UTF-32.*Save it as UTF-8"):
        files.read_configuration(tmp_path / "rig.toml")


def test_a_comma_for_two_things_is_named(tmp_path: Path) -> None:
    (tmp_path / "rig.csv").write_text(table(lambda rows: [row.replace(".", ",") for row in rows]))
    with pytest.raises(InputProblems, match="a comma between columns and as the decimal sign, too"):
        files.read_recording(tmp_path / "rig.csv")


def test_an_archive_of_zeros_is_refused_before_it_is_unpacked(tmp_path: Path) -> None:
    """Ten MB that hold 2.4 GB."""
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        head, {"descr": "<f8", "fortran_order": False, "shape": (300_000_000,)}
    )
    with (
        zipfile.ZipFile(tmp_path / "rig.npz", "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("time.npy", "w", force_zip64=True) as member,
    ):
        member.write(head.getvalue())
        for _ in range(2400):
            member.write(bytes(10**6))
    before = time.process_time()
    with pytest.raises(InputProblems, match=r"7\.21 GB of memory are needed.*--memory-limit 7\.3GB"):
        files.read_recording(tmp_path / "rig.npz")
    assert time.process_time() - before < 1.0


def test_every_problem_of_toml_and_files_comes_at_once(tmp_path: Path) -> None:
    (tmp_path / "text.csv").write_text(table(lambda rows: [*rows[:7], "0.007,abc,0", *rows[8:]]))
    (tmp_path / "units.csv").write_text(table())
    (tmp_path / "rig.toml").write_text("""
[nameplate]
inertia_motor = "abc"
stiffnes = 3
[[recording]]
file = "missing.csv"
[[recording]]
file = "text.csv"
window = [1]
[[recording]]
file = "units.csv"
channels.torque_motor = { column = 2, unit = "A", sing = 1 }
channels.speed_motor = { column = 1, unit = "rpm" }
[law]
poles = -1e9
kp = -1
""")
    found = "\n".join(map(str, files.find_problems(tmp_path / "rig.toml")))
    for words in (
        "line 3, nameplate.inertia_motor",
        "'stiffnes'",
        "missing.csv: got no such file",
        "text 'abc' in line 9",
        "recording[1].window",
        "'sing'",
        "add scale = 1",
        "law.poles",
        "law.kp",
    ):
        assert words in found  # fmt: skip


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"time": {"sample_time": 5}}, "Leave time out if the file is right"),
        ({"channels": {"speed_motor": 1, "torque_motor": {"column": 1, "scale": 1, "unit": "Nm"}}},
         "the same numbers for both"),
        ({"channels": {"speed_motor": {"column": 1, "unit": "rpm"}}}, "whose header says 'rad/s'"),
        ({"channels": {"speed_motor": {"column": 1, "scale": 1e300}}}, "Check the power of ten"),
        ({"resample": 1e-12}, "Choose a longer step"),
        ({"resample": "often"}, "'often', expected a number in s"),
    ],
    ids=lambda one: next(iter(one)) if isinstance(one, dict) else "",
)  # fmt: skip
def test_what_contradicts_the_file_is_refused(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    (tmp_path / "rig.csv").write_text(table())
    given = {"time": 0, **change} if "channels" in change else change
    with pytest.raises((InputProblems, InvalidInput)) as caught:
        files.read_recording(tmp_path / "rig.csv", **given)
    assert words in str(caught.value)

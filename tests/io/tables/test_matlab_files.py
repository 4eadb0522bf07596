"""MATLAB files: arrays, structs, cells, structure with time, and files that cannot be read."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lostmotion.errors import Problem
from lostmotion.io.recordings.read import read_recording

scipy_io = pytest.importorskip("scipy.io")

ROWS = 150
TIME = 0.01 * np.arange(ROWS)
WIDE = np.vstack([np.sin(TIME + i) for i in range(6)])
Problems = Callable[[Callable[[], object]], tuple[Problem, ...]]


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    """Arrays, a struct with a row matrix, a nested struct, a cell array and two structures with time."""
    cells = np.empty((1, 2), dtype=object)
    cells[0, 0], cells[0, 1] = WIDE[0], WIDE[1][:, None]
    signal_type = [("values", object), ("label", object)]
    signals = np.zeros((1, 2), dtype=signal_type)
    signals[0, 0] = (WIDE[2][:, None], "Speed [rpm]")
    signals[0, 1] = (WIDE[3][:, None], "Iq [A]")
    content: dict[str, Any] = {
        "t": TIME[:, None],
        "data": np.column_stack([TIME, WIDE.T]),
        "rec": {"pos": WIDE, "deep": {"er": WIDE[4]}, "flags": "text"},
        "cells": cells,
        "out": {"time": TIME[:, None], "signals": signals},
        "one": {"time": TIME[:, None] + 1.0, "signals": {"values": WIDE.T, "label": "torque_motor"}},
        "short": np.arange(5.0),
    }
    path = tmp_path / "rig.mat"
    scipy_io.savemat(path, content)
    return path


@pytest.mark.parametrize(
    ("column", "row"),
    [
        ("data[:,5]", 4),
        ("data[5]", 4),
        ("rec.pos[2]", 2),
        ("rec.pos[2,:]", 2),
        ("rec.pos[-1]", 5),
        ("rec.deep.er", 4),
        ("cells[0]", 0),
        ("cells{1}", 1),
        ("one.signals.values[:,3]", 3),
        ("out.signals[1].values", 3),
    ],
)
def test_paths(rig: Path, column: str, row: int) -> None:
    recording = read_recording(rig, time="t", channels={"torque_motor": {"column": column, "unit": "Nm"}})
    np.testing.assert_array_equal(recording["torque_motor"], WIDE[row])
    np.testing.assert_array_equal(recording.time, TIME)


def test_structure_with_time_by_label_gives_unit_and_time(rig: Path) -> None:
    channels = {"speed_motor": "out.Speed", "torque_motor": {"column": "out.Iq [A]", "scale": 1.9}}
    recording = read_recording(rig, channels=channels, time="out.time")
    np.testing.assert_allclose(recording["speed_motor"], WIDE[2] * np.pi / 30, rtol=1e-15)
    np.testing.assert_allclose(recording["torque_motor"], WIDE[3] * 1.9, rtol=1e-15)


def test_structure_with_time_brings_its_own_time(tmp_path: Path) -> None:
    path = tmp_path / "sim.mat"
    scipy_io.savemat(
        path, {"out": {"time": TIME, "signals": {"values": WIDE[0], "label": "speed_motor [rpm]"}}}
    )
    for channels in (None, {"speed_motor": "out.signals.values"}):
        recording = read_recording(path, channels=channels)
        np.testing.assert_array_equal(recording.time, TIME)
    assert "speed_motor" in read_recording(path)


def test_wrong_paths_are_named_with_close_matches(rig: Path, problems_of: Problems) -> None:
    channels = {
        "speed_motor": "rec.poss[0]",
        "torque_motor": "data[:,9]",
        "twist": "rec.pos",
        "angle_motor": "rec",
        "angle_load": "rec.flags",
        "speed_load": 3,
        "torque_shaft": "nothing.here",
    }
    found = {p.where.rsplit(", ")[-1]: p for p in problems_of(lambda: read_recording(rig, channels=channels))}
    assert set(found) == set(channels)
    assert "'rec.pos[0]'" in found["speed_motor"].remedy
    assert "shape (150, 7)" in found["torque_motor"].expected
    assert "rec.pos[:,0] or rec.pos[0,:]" in found["twist"].remedy
    assert "struct with the fields pos, deep, flags" in found["angle_motor"].got
    assert "data[:,3]" in found["speed_load"].remedy
    assert "rec.deep.er" in found["torque_shaft"].expected


def test_channels_of_different_length(rig: Path, problems_of: Problems) -> None:
    (problem,) = problems_of(lambda: read_recording(rig, channels={"speed_motor": "short"}))
    assert problem.got == "lengths speed_motor 5, time 150"


def test_version_7_3_says_how_to_save(tmp_path: Path, problems_of: Problems) -> None:
    path = tmp_path / "new.mat"
    for content in (
        b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n",
        b"\x89HDF\r\n\x1a\n" + b"\0" * 600,
    ):
        path.write_bytes(content)
        (problem,) = problems_of(lambda: read_recording(path))
        assert "7.3" in problem.got and "save('new.mat', '-v7')" in problem.remedy


def test_damaged_and_cut_files(rig: Path, problems_of: Problems) -> None:
    raw = rig.read_bytes()
    for content in (raw[: len(raw) // 2], b"", b"1,2,3\n" * 100, raw[:128] + b"\xff" * 200):
        rig.write_bytes(content)
        problem = problems_of(lambda: read_recording(rig, channels={"speed_motor": "rec.pos[0]"}))[0]
        assert problem.severity == "error" and str(rig) in problem.where


def test_compressed_files_and_integers(tmp_path: Path) -> None:
    buffer = io.BytesIO()
    scipy_io.savemat(buffer, {"time": TIME, "counts": np.arange(ROWS, dtype=np.int16)}, do_compression=True)
    path = tmp_path / "small.mat"
    path.write_bytes(buffer.getvalue())
    channel = {"column": "counts", "unit": "counts", "counts_per_rev": 100}
    recording = read_recording(path, channels={"angle_motor": channel})
    np.testing.assert_allclose(recording["speed_motor"], 2 * np.pi, rtol=1e-9)


def test_emps(real_data: Callable[[str], Path]) -> None:
    path = real_data("emps/DATA_EMPS.mat")
    channels = {
        "angle_motor": {"column": "qm", "unit": "m", "scale": 1.0},
        "torque_motor": {"column": "vir", "unit": "V", "scale": 35.1507},
    }
    recording = read_recording(path, channels=channels)
    assert len(recording) == 24840 and recording.dt == pytest.approx(1e-3, rel=1e-6)
    assert recording.meta["problems"] == ()
    channels["torque_motor"]["sign"] = -1
    (warning,) = read_recording(path, channels=channels).meta["problems"]
    assert "opposite sign" in warning.got and "sign = -1" in warning.remedy


def test_hsm150(real_data: Callable[[str], Path]) -> None:
    path = real_data("hsm150/idf_pos_0.06_1.mat")
    channels = {
        "speed_motor": "data[:,3]",
        "torque_motor": {"column": "data[:,6]", "unit": "A", "scale": 0.0458},
    }
    recording = read_recording(path, time="data[:,0]", channels=channels)
    from_current = read_recording(path, time="data[:,0]", channels={"torque_motor": "data[:,5]"})
    np.testing.assert_allclose(recording["torque_motor"], from_current["torque_motor"], rtol=1e-9, atol=1e-12)
    assert len(recording) == 20000


def test_kuka(real_data: Callable[[str], Path]) -> None:
    path = real_data("kuka/data_A.mat")
    channels = {
        "angle_motor": {"column": "rec.act_pos_mot_deg[2]", "unit": "deg"},
        "angle_load": {"column": "rec.act_pos_se_deg[2]", "unit": "deg"},
    }
    recording = read_recording(path, time="rec.time_cont", channels=channels)
    assert len(recording) == 2500 and recording.dt == pytest.approx(4e-3, rel=1e-6)
    # Motor and link encoder of one axis differ by the elastic angle and a delay alone, far below a degree.
    assert np.max(np.abs(recording["angle_motor"] - recording["angle_load"])) < np.deg2rad(1.0)
    assert recording.origin["speed_load"] == "derived"

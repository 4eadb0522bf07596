"""Recordings as .npz: exact round trips, same bytes, refusal of what is something else."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InvalidInput, Problem
from lostmotion.events import Event
from lostmotion.io.storage.recording_files import load_recording, save_recording
from lostmotion.recording import Recording

PROBLEM = Problem("warning", "here", "this", "that", "Do it.")


def recording() -> Recording:
    rng = np.random.default_rng(4)
    return Recording(
        np.cumsum(rng.random(50)) / 3.0,
        {"speed_motor": rng.normal(size=50), "torque_motor": np.full(50, np.nan)},
        {"speed_motor": "simulated"},
        (Event(0.1 / 3.0, "impact", "shaft", -1.0 / 3.0),),
        {"state": np.array([1.0 / 3.0, -0.0, 1e-300]), "time": 0.1},
        {
            "seed": 3,
            "problems": (PROBLEM,),
            "sources": {"speed_motor": "column 1"},
            "grid": np.eye(2),
            "file": Path("a/b"),
        },
    )


def test_recording_round_trip_is_exact(tmp_path: Path) -> None:
    original, path = recording(), tmp_path / "r.npz"
    save_recording(original, path)
    again = load_recording(path)
    assert again.time.tobytes() == original.time.tobytes()
    assert again.names == original.names
    assert all(again[name].tobytes() == original[name].tobytes() for name in original)
    assert (again.origin, again.events) == (original.origin, original.events)
    assert again.final_state["state"].tobytes() == original.final_state["state"].tobytes()
    assert again.final_state["time"] == 0.1
    assert again.meta["problems"] == [PROBLEM] and again.meta["sources"] == original.meta["sources"]
    assert again.meta["seed"] == 3 and again.meta["file"] == "a/b"
    np.testing.assert_array_equal(again.meta["grid"], np.eye(2))


def test_same_content_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import time

    save_recording(recording(), tmp_path / "a.npz")
    later = time.time() + 1e6
    monkeypatch.setattr(time, "time", lambda: later)
    save_recording(recording(), tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert {entry.date_time[0] for entry in archive.infolist()} == {1980}


def test_damaged_recordings_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "r.npz"
    save_recording(recording(), path)
    raw = path.read_bytes()
    np.savez(tmp_path / "other.npz", a=np.eye(2))
    for content in (raw[: len(raw) // 2], b"", b"hello", (tmp_path / "other.npz").read_bytes()):
        path.write_bytes(content)
        with pytest.raises(InvalidInput, match=r"r\.npz"):
            load_recording(path)


def test_a_recording_of_schema_version_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "old.npz"
    save_recording(Recording([0.0, 0.1], {"speed_motor": [1.0, 2.0]}, meta={"count_averaged": True}), path)
    with np.load(path) as file:
        arrays = dict(file)
    header = json.loads(str(arrays["header"]))
    arrays["header"] = np.array(json.dumps({**header, "schema_version": 1}))
    np.savez(path, **arrays)
    assert load_recording(path).meta == {"speed_from_counts": True}

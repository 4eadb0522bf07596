"""JSON and npz: exact round trips, same bytes, refusal of what is something else."""

from __future__ import annotations

import json
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest

from lostmotion.curves import dead_zone, saturation
from lostmotion.errors import InvalidInput, Problem
from lostmotion.events import Event
from lostmotion.io.storage.laws_and_recordings import (
    load_json,
    load_law,
    load_recording,
    save_json,
    save_law,
    save_recording,
)
from lostmotion.recording import Recording
from lostmotion.systems import DiscreteSystem

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


def test_json_numbers_are_exact_and_nan_becomes_null(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    data = {
        "a": 0.1 + 0.2,
        "tiny": 5e-324,
        "array": np.array([[1 / 3, -0.0], [np.nan, np.inf]]),
        "n": np.int64(3),
        "yes": np.bool_(True),
        "f": np.float64(1e23),
        "none": None,
        "bad": math.nan,
        "tuple": (1, "ä"),
        "problem": PROBLEM,
    }
    save_json(path, "thing", data)
    text = path.read_text(encoding="utf-8")
    assert "NaN" not in text and "Infinity" not in text and "0.30000000000000004" in text
    assert list(json.loads(text))[:2] == ["kind", "schema_version"]
    again = load_json(path, "thing")
    assert again["array"] == [[1 / 3, 0.0], [None, None]] and math.copysign(1, again["array"][0][1]) == -1
    assert again["a"] == 0.1 + 0.2 and again["tiny"] == 5e-324 and again["f"] == 1e23
    assert again["bad"] is None and again["none"] is None and again["n"] == 3 and again["yes"] is True
    assert again["tuple"] == [1, "ä"] and again["problem"] == PROBLEM.as_dict()
    assert set(again) == set(data)


def test_kind_and_schema_version_are_checked(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    save_json(path, "thing", {})
    with pytest.raises(InvalidInput, match="kind 'thing', expected kind 'law'"):
        load_json(path, "law")
    path.write_text(path.read_text().replace('"schema_version": 2', '"schema_version": 99'))
    with pytest.raises(InvalidInput, match="schema_version 99, expected schema_version 1 or 2"):
        load_json(path, "thing")
    for broken in ("{", "[1, 2]", ""):
        path.write_text(broken)
        with pytest.raises(InvalidInput, match=r"x\.json"):
            load_json(path, "thing")
    with pytest.raises(InvalidInput, match="got no such file, "):
        load_json(tmp_path / "none.json", "thing")


def test_what_json_cannot_hold_is_named(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="deep, x: got a complex"):
        save_json(tmp_path / "x.json", "thing", {"deep": {"x": 1j}})
    assert list(tmp_path.iterdir()) == []


def test_damaged_recordings_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "r.npz"
    save_recording(recording(), path)
    raw = path.read_bytes()
    np.savez(tmp_path / "other.npz", a=np.eye(2))
    for content in (raw[: len(raw) // 2], b"", b"hello", (tmp_path / "other.npz").read_bytes()):
        path.write_bytes(content)
        with pytest.raises(InvalidInput, match=r"r\.npz"):
            load_recording(path)


def test_a_failed_write_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "x.json"
    save_json(path, "thing", {"a": 1})

    def full(self: Path, content: bytes) -> int:
        with self.open("wb") as file:
            file.write(content[:5])
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InvalidInput, match="No space left on device"):
        save_json(path, "thing", {"a": 2})
    assert load_json(path, "thing") == {"a": 1}
    assert [p.name for p in tmp_path.iterdir()] == ["x.json"]
    monkeypatch.undo()
    monkeypatch.setattr(Path, "replace", lambda self, target: full(self, b""))
    with pytest.raises(InvalidInput, match="No space left on device"):
        save_json(path, "thing", {"a": 3})
    assert load_json(path, "thing") == {"a": 1}
    with pytest.raises(InvalidInput, match="folder"):
        save_json(tmp_path / "none" / "x.json", "thing", {})


def test_law_round_trip_is_exact(tmp_path: Path) -> None:
    rng = np.random.default_rng(9)
    shapes = {
        "A": (3, 3),
        "B": (3, 2),
        "E": (3, 2),
        "F": (2, 3),
        "G": (2, 2),
        "C": (1, 3),
        "D": (1, 2),
        "J": (1, 2),
    }
    law = DiscreteSystem(
        **{name: rng.normal(size=shape) for name, shape in shapes.items()},
        H=np.array([[0.0, 0.0], [1 / 3, 0.0]]),
        curves=(dead_zone(0.006, 6285.9), saturation(2.0, 1 / 3)),
        inputs=("speed_motor", "speed_reference"),
        outputs=("torque_motor",),
        states=("a", "b", "c"),
        dt=1e-4,
        name="law",
    )
    save_law(law, tmp_path / "law.json")
    again = load_law(tmp_path / "law.json")
    for name in (*shapes, "H", "initial_state"):
        assert getattr(again, name).tobytes() == getattr(law, name).tobytes(), name
    assert (again.curves, again.inputs, again.outputs, again.states) == (
        law.curves,
        law.inputs,
        law.outputs,
        law.states,
    )
    assert (again.dt, again.name) == (law.dt, law.name)


def test_a_recording_of_schema_version_1_is_read(tmp_path: Path) -> None:
    path = tmp_path / "old.npz"
    save_recording(Recording([0.0, 0.1], {"speed_motor": [1.0, 2.0]}, meta={"count_averaged": True}), path)
    with np.load(path) as file:
        arrays = dict(file)
    header = json.loads(str(arrays["header"]))
    arrays["header"] = np.array(json.dumps({**header, "schema_version": 1}))
    np.savez(path, **arrays)
    assert load_recording(path).meta == {"speed_from_counts": True}

"""The package's own JSON: exact numbers, kind and version, strict reading, whole or not at all."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InvalidInput, Problem
from lostmotion.io.storage.json_files import load_json, save_json

PROBLEM = Problem("warning", "here", "this", "that", "Do it.")


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


@pytest.mark.parametrize(
    ("text", "got"),
    [
        ('{"kind": "thing", "schema_version": 2, "a": 1, "a": 2}', "the key 'a' comes twice"),
        ('{"kind": "thing", "schema_version": 2, "a": NaN}', "NaN is no number"),
        ("[" * 5000, "hundreds of brackets"),
        ('{"kind": "thing", "schema_version": true}', "schema_version True"),
        ('{"a": ' + "9" * 5000 + "}", "broken JSON"),
        ("\ufeff\ufeff{}", "broken JSON"),
    ],
)
def test_json_that_readers_take_differently_is_refused(tmp_path: Path, text: str, got: str) -> None:
    (tmp_path / "x.json").write_text(text, encoding="utf-8")
    with pytest.raises(InvalidInput, match=got):
        load_json(tmp_path / "x.json", "thing")


def test_a_name_that_is_no_text_is_written_and_read_again(tmp_path: Path) -> None:
    """As Python gives a file name whose bytes are not UTF-8."""
    save_json(tmp_path / "x.json", "thing", {"a\udce4.csv": "\udce4"})
    assert load_json(tmp_path / "x.json", "thing") == {"a\udce4.csv": "\udce4"}


@pytest.mark.parametrize(
    ("name", "text", "got"),
    [
        ("law.json", " \n", "an empty file"),
        ("drivetrain.toml", 'kind = "drivetrain"', "a file with the ending '.toml' that is no JSON"),
        ("law.json", "[1, 2]", "nothing that says its kind"),
        ("law.json", "{", "broken JSON"),
    ],
)
def test_another_file_is_told_from_a_broken_one(tmp_path: Path, name: str, text: str, got: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InvalidInput, match=f"got {got}"):
        load_json(tmp_path / name, "law")

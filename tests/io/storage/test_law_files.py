"""law.json: exact round trips; nothing that was changed or lacks a part passes as a law."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lostmotion.controllers import pi
from lostmotion.curves import dead_zone, saturation
from lostmotion.errors import InvalidInput
from lostmotion.io.storage.law_files import load_law, save_law
from lostmotion.systems import DiscreteSystem, InputCheck


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


def checked_law() -> DiscreteSystem:
    return DiscreteSystem(
        inputs=("u", "y"), outputs=("z",), states=("x",), dt=0.1, A=[[0.5]], B=[[1.0, 0.25]], C=[[1.0]],
        checks=(InputCheck("y", 3.0, 5, 0.9),), P=[[2.0]], Q=[[1.5, 0.0]],
    )  # fmt: skip


def written(path: Path, **changes: Any) -> dict[str, Any]:
    """The content of a saved law with some keys changed, or with None left out."""
    save_law(checked_law(), path)
    content = {**json.loads(path.read_text()), **changes}
    content = {key: value for key, value in content.items() if value is not None}
    path.write_text(json.dumps(content))
    return content


@pytest.mark.parametrize("key", ["P", "Q", "R", "checks", "A", "curves", "initial_state", "name"])
def test_a_law_that_lacks_a_part_is_none(tmp_path: Path, key: str) -> None:
    path = tmp_path / "law.json"
    for gone, complaint in (({key: None}, "changed, or damaged"), ({"sha256": None}, "changed, or damaged")):
        written(path, **gone)
        with pytest.raises(InvalidInput, match=complaint):
            load_law(path)
    written(path, schema_version=1, sha256=None, **{key: None})
    with pytest.raises(InvalidInput, match=f"without {key}"):
        load_law(path)


@pytest.mark.parametrize(
    "changes", [{"A": [[0.50000001]]}, {"dt": 0.2}, {"inputs": ["y", "u"]}, {"sha256": "0"}, {"more": 1}]
)
def test_a_law_that_was_changed_is_none(tmp_path: Path, changes: dict[str, Any]) -> None:
    written(tmp_path / "law.json", **changes)
    with pytest.raises(InvalidInput, match=r"changed, or damaged.*change it in Python"):
        load_law(tmp_path / "law.json")


def test_a_file_of_before_there_were_checks_is_read(tmp_path: Path) -> None:
    gone = dict.fromkeys(("checks", "P", "Q", "R", "sha256"))
    written(tmp_path / "law.json", schema_version=1, **gone)
    assert load_law(tmp_path / "law.json").to_dict() == checked_law().without_checks().to_dict()


def test_a_file_of_before_there_were_kinds_of_checks_is_read(tmp_path: Path) -> None:
    checks = [{"input": "y", "limit": 3.0, "hold": 5, "forget": 0.9}]
    written(tmp_path / "law.json", schema_version=1, checks=checks, sha256=None)
    assert load_law(tmp_path / "law.json").to_dict() == checked_law().to_dict()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"A": []}, r"A: got shape \(0,\)"),
        ({"A": [["0.5"]]}, "A: got .*numbers"),
        ({"A": [[10**400]]}, "A: got"),
        ({"B": [[1.0], [2.0]]}, r"shape \(2, 1\), expected numbers of shape \(1, 2\)"),
        ({"dt": True}, "dt: got True"),
        ({"dt": 10**400}, "dt: got"),
        ({"inputs": "uy"}, "inputs: got 'uy', expected a list"),
        ({"inputs": ["u", 3]}, r"inputs\[1\]: got 3, expected a text"),
        ({"curves": [{"points": [[0, 1, 2]], "slope_left": 0, "slope_right": 0}]}, r"curves\[0\], points"),
        ({"curves": [{"points": [[0, 1]]}]}, r"curves\[0\]: got a table without slope_left"),
        ({"checks": [{}]}, "checks"),
        ({"name": 5}, "name: got 5"),
        ({"initial_state": {"x": 1}}, "initial_state"),
    ],
)
def test_values_of_another_type_are_named(tmp_path: Path, changes: dict[str, Any], message: str) -> None:
    written(tmp_path / "law.json", schema_version=1, sha256=None, **changes)
    with pytest.raises(InvalidInput, match=message) as caught:
        load_law(tmp_path / "law.json")
    assert caught.value.problem.where.startswith(str(tmp_path / "law.json"))


def test_the_law_of_a_controller_keeps_its_bits(tmp_path: Path) -> None:
    law = pi(dt=1e-3, torque_limit=5.0)
    save_law(law, tmp_path / "law.json")
    assert load_law(tmp_path / "law.json").to_dict() == law.to_dict()

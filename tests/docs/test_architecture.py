"""docs/architecture.md does what it says: the observer, the controller and the reader that it adds are whole ones."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lostmotion as lm

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "architecture.md"
SOURCE = ROOT / "src" / "lostmotion"


@pytest.fixture
def added(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What the page's blocks define, run in an empty folder."""
    from lostmotion.io import READERS

    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    known = dict(READERS)
    for block in re.findall(r"^```python\n(.*?)^```", PAGE.read_text(), re.MULTILINE | re.DOTALL):
        exec(compile(block, PAGE.name, "exec"), names)
    yield names
    READERS.clear()
    READERS.update(known)


def test_the_added_observer_follows_the_plant(added: dict[str, Any]) -> None:
    loop = added["loop"]
    estimated = added["observer"].run(loop)["speed_load_estimated"]
    assert np.max(np.abs(estimated - loop["speed_load"])[2000:]) < 0.05 * np.max(np.abs(loop["speed_load"]))


def test_the_added_law_closes_the_loop_and_is_exported(added: dict[str, Any], tmp_path: Path) -> None:
    assert abs(added["loop"]["speed_load"][-1] - 2.0) < 0.1
    parts = [added["observer"], added["controller"]]
    again = lm.simulate(added["plant"], law=parts, speed_reference=np.full(5000, 2.0), dt=1e-4)
    np.testing.assert_allclose(again["speed_load"], added["loop"]["speed_load"], rtol=0.0, atol=1e-9)
    assert (tmp_path / "new_law" / "new_law.c").is_file()


def test_the_added_reader_reads(added: dict[str, Any], tmp_path: Path) -> None:
    rows = [{"time": 1e-3 * k, "speed_motor": 0.1 * k, "torque_motor": 1.0} for k in range(200)]
    (tmp_path / "log.jsonl").write_text("\n".join(map(json.dumps, rows)))
    found = lm.read_recording(
        tmp_path / "log.jsonl",
        channels={"speed_motor": {"column": "speed_motor", "unit": "rpm"}, "torque_motor": "torque_motor"},
    )
    assert found["speed_motor"][10] == pytest.approx(2.0 * np.pi / 60.0)


def test_every_room_and_file_that_the_page_names_is_there() -> None:
    for named in re.findall(r"`([\w./]+(?:\.py|/))`", PAGE.read_text()):
        place = ROOT / named if named.startswith("tests") else SOURCE / named
        assert place.exists(), named


@pytest.mark.parametrize("top", [SOURCE, ROOT / "tests"], ids=["src", "tests"])
def test_no_folder_is_a_barrack(top: Path) -> None:
    """At most 15 files beside __init__.py in one folder, so that a newcomer finds the one he wants."""
    for folder in [top, *(p for p in top.rglob("*") if p.is_dir())]:
        files = [p.name for p in folder.glob("*.py") if p.name != "__init__.py"]
        assert len(files) <= 15, (folder, len(files))

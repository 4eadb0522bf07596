"""A compiled kernel is dropped when a kernel that it calls in another file has changed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from lostmotion.kernels import fresh_cache

CALLED = "from numba import njit\n\n@njit(cache=True)\ndef value():\n    return {}\n"
CALLER = """from numba import njit
from .called import value

@njit(cache=True)
def twice():
    return 2 * value()
"""
ALONE = "from numba import njit\n\n@njit(cache=True)\ndef one():\n    return 1\n"
INIT = """from pathlib import Path
from lostmotion.kernels.fresh_cache import drop_stale
drop_stale(Path(__file__).parent)
"""


def twice(folder: Path) -> str:
    code = "from toy.caller import twice; from toy.alone import one; one(); print(twice())"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_changed_callee_is_noticed(tmp_path):
    toy = tmp_path / "toy"
    toy.mkdir()
    for name, text in (
        ("called", CALLED.format(1)),
        ("caller", CALLER),
        ("alone", ALONE),
        ("__init__", INIT),
    ):
        (toy / f"{name}.py").write_text(text)
    assert twice(tmp_path) == "2"
    kept = {p.name: p.stat().st_mtime_ns for p in (toy / "__pycache__").glob("*.nbc")}
    assert any(name.startswith("caller") for name in kept)
    (toy / "called.py").write_text(CALLED.format(5))
    assert twice(tmp_path) == "10"
    after = {p.name: p.stat().st_mtime_ns for p in (toy / "__pycache__").glob("alone*.nbc")}
    assert after and all(kept[name] == time for name, time in after.items())


def test_unchanged_sources_drop_nothing(tmp_path):
    (tmp_path / "a.py").write_text("from .b import x\n")
    (tmp_path / "b.py").write_text("x = 1\n")
    assert fresh_cache.drop_stale(tmp_path) == ["a", "b"]
    assert fresh_cache.drop_stale(tmp_path) == []
    (tmp_path / "__pycache__" / "a.f-1.py311.nbi").write_text("compiled")
    (tmp_path / "b.py").write_text("x = 2\n")
    assert fresh_cache.drop_stale(tmp_path) == ["a", "b"]
    assert not list((tmp_path / "__pycache__").glob("*.nbi"))


def test_imports_are_followed_through():
    hashes = fresh_cache.source_hashes(Path(fresh_cache.__file__).parent)
    assert {"plant/event_loop", "law/step", "loop/laws", "estimators/interacting_models/step"} <= set(hashes)
    assert len(set(hashes.values())) == len(hashes)


def test_a_change_in_another_room_is_noticed(tmp_path):
    """Across folders, upwards, downwards, by module and by name."""
    for room in ("a", "b", "b/c"):
        (tmp_path / room).mkdir()
    (tmp_path / "a" / "one.py").write_text("from ..b.two import (\n    x,\n)\n")
    (tmp_path / "b" / "two.py").write_text("from .c import three\n")
    (tmp_path / "b" / "c" / "three.py").write_text("x = 1\n")
    (tmp_path / "b" / "alone.py").write_text("x = 1\n")
    before = fresh_cache.source_hashes(tmp_path)
    (tmp_path / "b" / "c" / "three.py").write_text("x = 2\n")
    after = fresh_cache.source_hashes(tmp_path)
    assert {name for name in before if before[name] != after[name]} == {"a/one", "b/two", "b/c/three"}
    fresh_cache.drop_stale(tmp_path)
    compiled = tmp_path / "a" / "__pycache__" / "one.f-1.py311.nbi"
    compiled.parent.mkdir()
    compiled.write_text("compiled")
    (tmp_path / "b" / "c" / "three.py").write_text("x = 3\n")
    assert fresh_cache.drop_stale(tmp_path) == ["a/one", "b/c/three", "b/two"]
    assert not compiled.exists()

"""A compiled kernel is dropped when a kernel that it calls in another file has changed."""

from __future__ import annotations

from pathlib import Path

from lostmotion.kernels import fresh_cache


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

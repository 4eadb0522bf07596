"""Kernels are compiled part by part, in processes of their own, and only once."""

from __future__ import annotations

from pathlib import Path

import pytest

from lostmotion import precompile
from lostmotion.kernels import compiled


@pytest.fixture
def marks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder without marks; the compiled kernels themselves are taken from beside their sources, if there are any."""
    monkeypatch.setattr(compiled, "_BESIDE", tmp_path / "beside")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "own"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    return tmp_path


def test_each_step_of_a_part_is_counted(marks: Path) -> None:
    seen: list[tuple[int, int]] = []
    precompile.compile_missing(["identification"], lambda done, count: seen.append((done, count)))
    assert seen == [(0, 2), (1, 2), (2, 2)]
    assert compiled.is_compiled("identification")
    precompile.compile_missing(["identification"], lambda done, count: pytest.fail("compiled twice"))


def test_a_part_that_fails_is_left_to_the_first_call(marks: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(precompile, "PARTS", {"no such part": {"nothing": lambda: None}})
    precompile.compile_missing(["no such part"], lambda done, count: None)
    assert not compiled.is_compiled("no such part")


def test_every_kind_of_estimator_is_a_step() -> None:
    assert len(precompile.PARTS["observers"]) == len(precompile.MODULES)

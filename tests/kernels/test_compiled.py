"""The mark of compiled kernels is that of these sources, this Python, numba and processor."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from lostmotion.kernels import compiled


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Marks stand in a folder of the test's own."""
    monkeypatch.setattr(compiled, "_BESIDE", tmp_path / "beside")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "own"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    compiled._key.cache_clear()
    yield tmp_path
    compiled._key.cache_clear()


def test_a_mark_is_for_its_part() -> None:
    assert not compiled.is_compiled("simulation")
    compiled.mark_compiled("simulation")
    assert compiled.is_compiled("simulation") and not compiled.is_compiled("observers")


def test_a_mark_of_the_installation_counts_where_numba_keeps_its_files_elsewhere(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    compiled.mark_compiled("simulation")
    assert list((place / "beside").iterdir())
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(place / "own"))
    assert compiled.is_compiled("simulation")


@pytest.mark.parametrize("variable", ["NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"])
def test_another_processor_needs_its_own(variable: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled.mark_compiled("simulation")
    monkeypatch.setenv(variable, "generic")
    compiled._key.cache_clear()
    assert not compiled.is_compiled("simulation")


def test_where_nothing_can_be_written_nothing_is_remembered(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("own", "beside", "user"):
        (place / name).write_text("a file where the folder should be")
    compiled.mark_compiled("simulation")
    assert not compiled.is_compiled("simulation")

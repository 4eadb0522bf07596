"""A command's kernels are compiled before it begins, and its user sees how far this is."""

from __future__ import annotations

import pytest

from lostmotion import precompile
from lostmotion.cli import compiling


def test_nothing_is_said_where_nothing_is_to_do(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiling, "is_compiled", lambda part: True)
    monkeypatch.setattr(precompile, "compile_missing", lambda *args: pytest.fail("compiled"))
    compiling.compile_kernels("simulation")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("shown", [True, False])
def test_the_user_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], shown: bool
) -> None:
    monkeypatch.setattr(compiling, "is_compiled", lambda part: False)
    parts: list[str] = []
    monkeypatch.setattr(precompile, "compile_missing", lambda which, progress: parts.extend(which))
    compiling.compile_kernels("simulation", "observers", shown=shown)
    assert parts == ["simulation", "observers"]
    assert ("compiling kernels" in capsys.readouterr().err) == shown

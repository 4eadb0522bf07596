"""lostmotion paper: what it passes on, and what it says afterwards."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import lostmotion.paper
from lostmotion.cli import app, reproduction

CLAIM = {"name": "the rig is round", "verdict": "does not hold", "sentence": "It is long."}
CONTENT = {
    "headline": "1 of 2 claims hold, 1 not.",
    "claims": [CLAIM, {**CLAIM, "name": "other", "verdict": "holds"}],
}


@pytest.fixture
def given(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """The arguments of the job, which is not done."""
    seen: dict[str, Any] = {}

    def reproduce(out: Path, **options: Any) -> dict[str, Any]:
        seen.update(options, out=out)
        return CONTENT

    monkeypatch.setattr(lostmotion.paper, "reproduce", reproduce)
    monkeypatch.setattr(reproduction, "compile_kernels", lambda *parts, shown: seen.update(parts=parts))
    return seen


def test_it_tells_what_does_not_hold_and_where_the_page_is(given: dict[str, Any]) -> None:
    done = CliRunner().invoke(app, ["paper", "--quick", "--out", "there"])
    assert done.exit_code == 0, done.output
    assert "1 of 2 claims hold, 1 not." in done.stdout
    assert "does not hold: the rig is round. It is long." in done.stdout and "other" not in done.stdout
    assert f"page: {Path('there') / 'paper.html'}" in done.stdout
    assert (given["out"], given["quick"], given["force"]) == (Path("there"), True, False)
    assert given["parts"] == ("simulation", "identification", "observers")


def test_json_alone_is_printed(given: dict[str, Any]) -> None:
    done = CliRunner().invoke(app, ["paper", "--json"])
    assert json.loads(done.stdout) == CONTENT
    assert (given["out"], given["quick"]) == (Path("lostmotion-paper"), False)


def test_quiet_says_nothing(given: dict[str, Any]) -> None:
    assert CliRunner().invoke(app, ["paper", "-q"]).output == ""

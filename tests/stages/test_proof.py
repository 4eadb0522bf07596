"""The proof goes on beside other stages, and ends when the run does."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from types import SimpleNamespace
from typing import Any

import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.stages.proof import Stopped, prove


def laws(law: lm.DiscreteSystem | None) -> Any:
    return SimpleNamespace(law=law, skipped="unstable loop")


def test_it_stops_with_the_run(tmp_path: Path) -> None:
    stop = Event()
    stop.set()
    with pytest.raises(Stopped):
        prove(laws(lm.controllers.pi(dt=1e-4)), PAPER, tmp_path, stop)
    assert not list(tmp_path.iterdir())


def test_it_writes_certificate_and_verifier(tmp_path: Path) -> None:
    stability = prove(laws(lm.controllers.pi(dt=1e-4)), PAPER, tmp_path, Event())
    assert stability["proved"]
    assert {file.name for file in tmp_path.iterdir()} == {"certificate.json", "certificate_verify.py"}


def test_without_a_law_there_is_nothing_to_prove(tmp_path: Path) -> None:
    assert prove(laws(None), None, tmp_path, Event()) == {"skipped": "unstable loop"}

"""The proof goes on in a process beside other stages, and ends when the run does."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.stages.proof import prover


def laws(law: lm.DiscreteSystem | None) -> Any:
    return SimpleNamespace(law=law, skipped="unstable loop")


def test_it_ends_with_the_run(tmp_path: Path) -> None:
    with prover() as proof:
        proof.begin(laws(lm.controllers.pi(dt=1e-4)), PAPER, tmp_path)
    assert proof.child.poll() is not None and not list(tmp_path.iterdir())


@pytest.mark.parametrize("ended", [False, True])
def test_it_writes_certificate_and_verifier_also_where_its_process_has_ended(
    tmp_path: Path, ended: bool
) -> None:
    with prover() as proof:
        if ended:
            proof.child.kill()
            proof.child.wait()
        proof.begin(laws(lm.controllers.pi(dt=1e-4)), PAPER, tmp_path)
        assert proof.result()["proved"]
    assert {file.name for file in tmp_path.iterdir()} == {"certificate.json", "certificate_verify.py"}


@pytest.mark.parametrize("executable", [None, "", "/nowhere/python"])
def test_where_no_process_can_be_started_this_one_proves(
    tmp_path: Path, monkeypatch: Any, executable: Any
) -> None:
    """As in a program that has Python built in."""
    monkeypatch.setattr(sys, "executable", executable)
    with prover() as proof:
        assert proof.child is None
        proof.begin(laws(lm.controllers.pi(dt=1e-4)), PAPER, tmp_path)
        assert proof.result()["proved"]
    assert {file.name for file in tmp_path.iterdir()} == {"certificate.json", "certificate_verify.py"}


def test_without_a_law_there_is_nothing_to_prove(tmp_path: Path) -> None:
    with prover() as proof:
        proof.begin(laws(None), None, tmp_path)
        assert proof.result() == {"skipped": "unstable loop"}

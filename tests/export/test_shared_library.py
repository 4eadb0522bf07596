"""The exported C as a library: the same bits as the law, and a clear word where it cannot be built."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.export import compiler, shared_library
from lostmotion.realtime.law_steps import exported_step, own_step

LAW = lm.observers.kalman(PAPER, dt=1e-4)


@pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler")
def test_it_steps_as_the_law_does_faults_included(tmp_path: Path) -> None:
    steps = own_step(LAW), exported_step(shared_library(LAW, tmp_path / "c"), LAW)
    inputs = np.random.default_rng(1).normal(size=(300, len(LAW.inputs)))
    inputs[50, 0] = np.nan
    answers = [[step(row.tobytes()) for row in inputs] for step in steps]
    assert answers[0] == answers[1]
    assert answers[0][50][0] != 0
    assert np.isfinite(struct.unpack(f"={len(LAW.outputs)}d", answers[0][-1][1])).all()
    # Each has a memory of its own.
    again = exported_step(tmp_path / "c" / "law.so", LAW)
    assert again(inputs[0].tobytes()) == answers[1][0]


def test_without_a_compiler_it_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiler.shutil, "which", lambda name: None)
    with pytest.raises(InvalidInput, match="no C compiler"):
        shared_library(LAW, tmp_path)


def test_what_the_compiler_says_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = tmp_path / "cc"
    script.write_text("#!/bin/sh\necho no room on the disk >&2\nexit 1\n")
    script.chmod(0o755)
    monkeypatch.setenv("CC", str(script))
    with pytest.raises(InvalidInput, match="no room on the disk"):
        shared_library(LAW, tmp_path / "c")

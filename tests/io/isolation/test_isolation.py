"""A foreign file that crashes its reader, hangs it or takes all memory ends a child process, never the user's."""

from __future__ import annotations

import io
import os
import pickle
import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from lostmotion import child_process
from lostmotion.errors import InvalidInput
from lostmotion.io.isolation import child, parent
from lostmotion.io.isolation.formats import READERS, TooLarge
from lostmotion.io.isolation.parent import read_isolated
from lostmotion.io.tables.matrices import read_torsional_model
from lostmotion.memory import VARIABLE

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux forks a process for each file")


def saved(compressed: bool = False, **variables: object) -> bytes:
    stream = io.BytesIO()
    savemat(stream, variables, do_compression=compressed)
    return stream.getvalue()


def read(raw: bytes) -> dict[str, np.ndarray]:
    return read_isolated("mat", raw, "a.mat", "a MATLAB file", "Copy it again.")


@linux
def test_a_crash_is_an_error_and_the_next_file_is_read(tmp_path: Path) -> None:
    """scipy's MatrixMarket reader ends the process on this one."""
    (tmp_path / "m.mtx").write_text(
        "%%MatrixMarket matrix coordinate real general\n2 2 2\n0 0 1.0\n9999999 1 1.0\n"
    )
    with pytest.raises(InvalidInput) as caught:
        read_torsional_model(tmp_path / "m.mtx", tmp_path / "m.mtx")
    assert "crashes its reader" in caught.value.problem.got or "no readable file" in caught.value.problem.got
    np.testing.assert_array_equal(read(saved(x=np.eye(3)))["x"], np.eye(3))


@linux
@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "crashes its reader"),
        ("import os; os._exit(3)", "crashes its reader"),
        ("import time; time.sleep(60)", "not read within 1 s"),
        ("while True: pass", "not read within 1 s"),
        ("x = bytearray(2 * 10**9)", "more than 1 GB of memory"),
        ("raise ValueError('no such tag')", "no such tag"),
        ("print('noise')", ""),
    ],
)
def test_whatever_a_reader_does(monkeypatch: pytest.MonkeyPatch, code: str, words: str) -> None:
    """A child whose reader runs the code, in the place of scipy's."""
    prepared = "from lostmotion.io.isolation import formats; "
    prepared += f"formats.READERS = {{'mat': lambda raw, m: exec({code!r})}}; "
    prepared += "from lostmotion.io.isolation import child; child.READERS = formats.READERS; "
    # The first call, which imports what a reader needs, is left out.
    prepared += "child.preload = lambda: None; "
    monkeypatch.setattr(
        child_process, "_CODE", child_process._CODE.replace("getattr", prepared + "getattr", 1)
    )
    monkeypatch.setattr(parent, "SECONDS", 1.0)
    parent._drop_own()
    before = time.monotonic()
    try:
        if words:
            with pytest.raises(InvalidInput, match=words):
                read(b"anything")
        else:
            assert read(b"anything") is None
        assert time.monotonic() - before < 30.0
    finally:
        parent._drop_own()


def test_variables_come_as_they_were_saved() -> None:
    cells = np.empty(2, dtype=object)
    cells[:] = [np.arange(3.0), "text"]
    variables = {
        "x": np.arange(6.0).reshape(2, 3), "flag": True, "text": "ä", "whole": np.arange(4, dtype=np.int16),
        "nested": {"a": {"b": np.eye(2)}}, "cells": cells,
    }  # fmt: skip
    for compressed in (False, True):
        found = read(saved(compressed, **variables))
        assert set(found) == set(variables)
        np.testing.assert_array_equal(found["x"], variables["x"])
        assert found["whole"].dtype == np.int16 and found["text"][0] == "ä"
        np.testing.assert_array_equal(found["nested"][0, 0]["a"][0, 0]["b"], np.eye(2))
        np.testing.assert_array_equal(found["cells"][0, 0], [[0.0, 1.0, 2.0]])


def test_what_is_no_array_is_left_out() -> None:
    from scipy.sparse import csc_array

    assert read(saved(sparse=csc_array(np.eye(3)), x=1.0))["sparse"] is None


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("nested", [False, True])
def test_memory_is_counted_before_it_is_taken(
    monkeypatch: pytest.MonkeyPatch, compressed: bool, nested: bool
) -> None:
    """32 MB of zeros, 0.03 MB when they are compressed; the limit that the message names is enough."""
    zeros = np.zeros(4_000_000)
    raw = saved(compressed, x={"y": zeros} if nested else zeros)
    monkeypatch.setenv(VARIABLE, "60MB")
    with pytest.raises(InvalidInput, match="MB of memory are needed") as caught:
        read(raw)
    limit = re.search(r"--memory-limit (\d+)MB", str(caught.value))
    assert limit is not None and 64 < int(limit[1]) < 200
    monkeypatch.setenv(VARIABLE, f"{limit[1]}MB")
    assert read(raw)["x"].size in (1, 4_000_000)


def test_counting_stops_where_it_is_too_much_already() -> None:
    raw = saved(True, x=np.zeros(4_000_000))
    with pytest.raises(TooLarge) as caught:
        READERS["mat"](raw, 1e6)
    assert caught.value.needed > 3e6


@linux
def test_the_child_ends_with_its_parent_and_costs_little() -> None:
    code = (
        "import os, sys; from lostmotion.io.isolation import parent; "
        "parent.read_isolated('mat', sys.stdin.buffer.read(), '', '', ''); print(parent._child().pid)"
    )
    before = time.monotonic()
    for ending in ("", "; sys.stdout.flush(); os._exit(0)"):
        done = subprocess.run(
            [sys.executable, "-c", code + ending], input=saved(x=1.0), capture_output=True, check=True
        )
        deadline = time.monotonic() + 20.0
        while Path(f"/proc/{int(done.stdout)}").exists() and time.monotonic() < deadline:
            time.sleep(0.02)
        assert not Path(f"/proc/{int(done.stdout)}").exists()
    assert time.monotonic() - before < 40.0


def test_a_fork_gets_a_child_of_its_own() -> None:
    read(saved(x=1.0))
    before = parent._children[os.getpid()].pid
    if not hasattr(os, "fork"):
        pytest.skip("no fork")
    process = os.fork()
    if process == 0:
        read(saved(x=1.0))
        os._exit(0 if parent._children[os.getpid()].pid != before else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == 0
    assert read(saved(x=2.0))["x"] == 2.0


@pytest.mark.parametrize("can_fork", [True, False])
def test_one_process_for_each_file_where_none_can_be_forked(can_fork: bool) -> None:
    if can_fork and sys.platform != "linux":
        pytest.skip("only Linux forks")
    code = "import lostmotion.io.isolation.child as child\n"
    code += f"child.CAN_FORK = {can_fork}\nchild.serve()"
    requests = [pickle.dumps(("mat", 1e9, 4.0, saved(x=float(i)))) for i in range(2)]
    done = subprocess.run(
        [sys.executable, "-c", code], input=b"".join(requests), capture_output=True, check=True
    )
    stream = io.BytesIO(done.stdout)
    answers = [parent._read(stream) for _ in range(2 if can_fork else 1)]  # type: ignore[arg-type]
    assert [(status, float(found["x"].item())) for status, found in answers] == [
        (child.READ, float(i)) for i in range(len(answers))
    ]
    assert stream.read() == b""

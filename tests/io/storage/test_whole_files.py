"""Whole files: what is no file is never replaced by one, and a missing file is told from a link to nowhere."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from lostmotion.errors import InvalidInput
from lostmotion.io.storage.whole_files import read_bytes, write_bytes


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes in folders here")
def test_a_pipe_is_not_replaced(tmp_path: Path) -> None:
    """Nor a device: a rename would put a file in its place, for everybody who uses it."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(InvalidInput, match="a device or a pipe"):
        write_bytes(pipe, b"1")
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [file.name for file in tmp_path.iterdir()] == ["pipe"]


def test_a_link_to_nowhere_is_said(tmp_path: Path) -> None:
    (tmp_path / ".hidden.toml").touch()
    link = tmp_path / "link.toml"
    link.symlink_to(tmp_path / "nowhere.toml")
    with pytest.raises(InvalidInput, match="a link to a file that is not there") as caught:
        read_bytes(link)
    assert (
        caught.value.problem.remedy == "Check the path."
    )  # neither the link itself nor a hidden file is offered

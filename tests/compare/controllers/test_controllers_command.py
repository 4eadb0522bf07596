"""lostmotion compare controllers, as a user calls it: its lists, a wrong name, a part of the table."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from lostmotion.compare.controllers import CASES, CONTESTANTS


def call(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "lostmotion", "compare", "controllers", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=cwd, check=False)


def test_lists_and_wrong_names(tmp_path: Path) -> None:
    listed = call("--list", cwd=tmp_path)
    names = [line.strip() for line in listed.stdout.splitlines() if line.startswith("  ")]
    assert names == [entry.name for entry in (*CASES, *CONTESTANTS)]
    wrong = call("--controller", "soft landin", cwd=tmp_path)
    assert wrong.returncode == 1 and "'soft landing'" in wrong.stderr and "Traceback" not in wrong.stderr
    assert not list(tmp_path.iterdir())


def test_a_part_of_the_table(tmp_path: Path) -> None:
    done = call("--seeds", "1", "--case", "step", "--controller", "PI, Table II", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "controllers-part"
    files = {f"leaderboard.{ending}" for ending in ("json", "csv", "md", "svg")}
    assert {path.name for path in folder.iterdir()} >= {*files, "scores"}
    assert "| PI, Table II |" in done.stdout and "401" in next((folder / "scores").iterdir()).name

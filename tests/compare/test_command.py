"""lostmotion compare observers, as a user calls it: files, exit codes, that it goes on, that it stops at once."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lostmotion.compare import CASES, CONTESTANTS, Leaderboard

SMALL = ("--quick", "--seeds", "1", "--case", "nominal", "--observer", "motor speed")
FILES = {f"leaderboard.{ending}" for ending in ("json", "csv", "md", "svg")}


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "lostmotion", "compare", "observers", *arguments]


def call(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command(*arguments), capture_output=True, text=True, timeout=300, cwd=cwd, check=False
    )


def test_files_and_that_it_goes_on(tmp_path: Path) -> None:
    done = call(*SMALL, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "compare …" in done.stderr and "compare done in" in done.stderr
    folder = tmp_path / "leaderboard-part"
    assert [p.name for p in tmp_path.iterdir()] == [folder.name]
    assert {p.name for p in folder.iterdir()} == {*FILES, "scores", ".lostmotion-files.json"}
    assert all(f"leaderboard-part/{name}" in done.stdout for name in FILES)
    assert done.stdout.startswith((folder / "leaderboard.md").read_text())
    board = json.loads((folder / "leaderboard.json").read_text())
    assert [row["name"] for row in board["observers"]] == ["Observer 1", "motor speed"]
    assert (board["seeds"], board["settings"]) == ([501], {"duration": 1.5, "quick": True, "part": True})
    (score,) = (folder / "scores").glob("*/*.json")
    before = {name: (folder / name).read_bytes() for name in FILES - {"leaderboard.svg"}}
    written = score.stat().st_mtime_ns
    again = call(*SMALL, "--case", "drop-outs 2 %", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert score.stat().st_mtime_ns == written
    assert len(list((folder / "scores").glob("*/*.json"))) == 2
    assert call(*SMALL, cwd=tmp_path).returncode == 0
    # The same bytes: even the times come from the kept scores.
    assert {name: (folder / name).read_bytes() for name in before} == before


def test_wrong_names_are_one_clear_error(tmp_path: Path) -> None:
    for option in ("--case", "--observer"):
        done = call(option, "wild", cwd=tmp_path)
        assert done.returncode == 1
        assert "wild" in done.stderr and "Traceback" not in done.stderr
    assert call("--seeds", "0", cwd=tmp_path).returncode == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name == "nt", reason="signals as on POSIX systems")
def test_ctrl_c_stops_at_once_and_says_what_is_kept(tmp_path: Path) -> None:
    many = ("--seeds", "500", "--case", "nominal", "--observer", "motor speed")
    with subprocess.Popen(command(*many), stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stderr is not None
        while not list(tmp_path.glob("leaderboard-part/scores/*/*.json")) and process.poll() is None:
            time.sleep(0.05)
        before = time.monotonic()
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        assert process.wait(timeout=60) == 130, rest
    assert time.monotonic() - before < 5.0
    words = " ".join(rest.split())
    assert "finished parts are kept in leaderboard-part/scores, the same command continues" in words
    assert "earlier output" not in words and "Traceback" not in rest


@pytest.mark.skipif(os.name == "nt", reason="signals as on POSIX systems")
def test_ctrl_c_before_the_first_score_promises_no_files(tmp_path: Path) -> None:
    long = ("--case", "nominal", "--observer", "moving horizon")
    with subprocess.Popen(command(*long), stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stderr is not None
        assert process.stderr.readline() == "compare …\n"
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        assert process.wait(timeout=60) == 130, rest
    assert not list(tmp_path.rglob("*.json"))
    assert rest.splitlines()[-1] == "Interrupted; an earlier output is unchanged."


def test_a_wrong_name_is_told_with_the_nearest_and_the_way_to_the_list(tmp_path: Path) -> None:
    done = call("--case", "inertia_laod -20 %", cwd=tmp_path)
    words = " ".join(done.stderr.split())
    assert done.returncode == 1
    assert "Did you mean 'inertia_load −20 %'" in words and len(words) < 400
    assert "`lostmotion compare observers --list` lists all names" in words
    assert "--list" in call("--help", cwd=tmp_path).stdout
    listed = call("--list", cwd=tmp_path)
    assert listed.returncode == 0
    names = [line.strip() for line in listed.stdout.splitlines() if line.startswith("  ")]
    assert names == [entry.name for entry in (*CASES, *CONTESTANTS)]
    assert not list(tmp_path.iterdir())


def test_a_part_never_replaces_the_whole_table(tmp_path: Path) -> None:
    """Half an hour of work stood in leaderboard.md; the row of one observer was written over it."""
    everyone = {entry.name: entry.kind for entry in CONTESTANTS}
    scores = {case.name: {1: {}} for case in CASES}
    settings = {"duration": 3.0, "quick": False, "part": False}
    whole = tmp_path / "leaderboard"
    whole.mkdir()
    Leaderboard(everyone, CASES, (1,), scores, settings).write(whole)
    before = {path.name: path.read_bytes() for path in whole.iterdir()}
    assert call(*SMALL, cwd=tmp_path).returncode == 0
    assert {path.name for path in tmp_path.iterdir()} == {"leaderboard", "leaderboard-part"}
    refused = call(*SMALL, "--out", "leaderboard", cwd=tmp_path)
    assert refused.returncode == 1
    words = " ".join(refused.stderr.split())
    assert f"{len(CONTESTANTS) - 2} of its observers, {len(CASES) - 1} of its cases" in words
    assert "its longer recordings" in words and "--force" in words
    assert {path.name: path.read_bytes() for path in whole.iterdir()} == before
    assert call(*SMALL, "--out", "leaderboard", "--force", cwd=tmp_path).returncode == 0
    assert json.loads((whole / "leaderboard.json").read_text())["settings"]["part"]


def test_lines_without_a_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    from lostmotion.terminal import StageLines

    with StageLines(every=0.1) as lines:
        for k in range(101):
            lines("compare", k / 100.0, "text")
        lines("compare", 1.0)
    told = capfd.readouterr().err.splitlines()
    assert told[0] == "compare …" and told[-1].startswith("compare done in")
    assert [line.split()[1] for line in told[1:-1]] == [f"{p}" for p in range(10, 100, 10)]

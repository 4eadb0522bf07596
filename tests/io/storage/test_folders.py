"""output_folder: whole or not at all, under every fault that could be thought of."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from lostmotion.errors import InvalidInput
from lostmotion.io.storage.folders import foreign_files, output_folder
from lostmotion.io.storage.json_files import save_json
from lostmotion.io.storage.written_files import MANIFEST, replacing


def run(path: Path, force: bool = False, **files: str) -> None:
    with output_folder(path, force) as folder:
        for name, text in files.items():
            target = folder / name.replace("__", "/").replace("_", ".")
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text)


def content(path: Path) -> dict[str, str]:
    return {
        p.relative_to(path).as_posix(): p.read_text()
        for p in sorted(path.rglob("*"))
        if p.is_file() and p.name != MANIFEST
    }


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """The output of a first run, alone in its parent folder."""
    path = tmp_path / "parent" / "out"
    run(path, report_html="one", c__law_c="one", old_txt="one")
    return path


FIRST = {"report.html": "one", "c/law.c": "one", "old.txt": "one"}


def alone(path: Path) -> bool:
    return [p.name for p in path.parent.iterdir()] == [path.name]


def test_a_new_folder_appears_with_its_parents_and_ordinary_rights(out: Path) -> None:
    assert content(out) == FIRST and alone(out) and foreign_files(out) == []
    beside = out.parent / "beside"
    beside.mkdir()
    assert out.stat().st_mode == beside.stat().st_mode


def test_a_later_run_replaces_what_an_earlier_one_wrote(out: Path) -> None:
    run(out, report_html="two", c__law_h="two")
    assert content(out) == {"report.html": "two", "c/law.h": "two"} and alone(out)


def test_an_empty_folder_is_taken(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    run(tmp_path / "out", a_txt="1")
    assert content(tmp_path / "out") == {"a.txt": "1"}


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, SystemExit, OSError])
def test_any_exception_leaves_the_previous_output(out: Path, error: type[BaseException]) -> None:
    with pytest.raises(error), output_folder(out) as folder:
        (folder / "report.html").write_text("half")
        raise error()
    assert content(out) == FIRST and alone(out)


@pytest.mark.parametrize("foreign", ["thesis.tex", "c/mine.c", "notes/a/b.txt", "empty/"])
def test_foreign_files_are_refused_before_the_work_starts(out: Path, foreign: str) -> None:
    target = out / foreign
    if foreign.endswith("/"):
        target.mkdir()
    else:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text("mine")
    before = content(out)
    with pytest.raises(InvalidInput, match=foreign), output_folder(out):
        pytest.fail("the work was started")
    assert content(out) == before and alone(out)


def test_a_file_changed_by_hand_is_foreign_and_kept_with_force(out: Path) -> None:
    (out / "c" / "law.c").write_text("mine")
    assert foreign_files(out) == ["c/law.c"]
    with pytest.raises(InvalidInput, match=r"changed since: c/law\.c"), output_folder(out):
        pytest.fail("the work was started")
    run(out, True, c__law_c="two")
    assert content(out) == {"c/law.c": "two", "c/law.c.kept": "mine"}


def test_a_file_changed_during_the_run_is_kept(out: Path) -> None:
    with output_folder(out) as folder:
        (folder / "old.txt").write_text("two")
        (out / "old.txt").write_text("mine")
    assert content(out) == {"old.txt": "two", "old.txt.kept": "mine"}


def test_a_command_replaces_what_the_run_wrote_and_the_run_what_the_command_wrote_for_it(out: Path) -> None:
    """One manifest: certify writes a run's certificate anew, and the next run takes it for its own."""
    law = out / "c" / "law.c"
    for text in ("by a command", "by another one"):
        with replacing(law):
            law.write_text(text)
        assert foreign_files(out) == []
    law.write_text("mine")
    with pytest.raises(InvalidInput, match=r"changed since: law\.c"), replacing(law):
        pytest.fail("the work was started")
    law.write_text("by another one")
    run(out, a_txt="two")
    assert content(out) == {"a.txt": "two"}


def test_a_run_takes_no_file_away_that_a_command_put_beside_its_own(out: Path) -> None:
    for text in ("one", "two"):  # of a command, which may replace it, before and after a run
        with replacing(out / "box.json"):
            (out / "box.json").write_text(text)
        with pytest.raises(InvalidInput, match=r"box\.json"), output_folder(out):
            pytest.fail("the work was started")
        run(out, True, a_txt=text)
        assert content(out) == {"a.txt": text, "box.json": text}


def test_a_folder_without_manifest_or_with_a_broken_one_is_foreign(out: Path) -> None:
    for text in ("{", '{"kind": "output_folder", "schema_version": 1}', '{"kind": "x"}'):
        (out / MANIFEST).write_text(text)
        with pytest.raises(InvalidInput, match="files that no run has written"), output_folder(out):
            pytest.fail("the work was started")
    (out / MANIFEST).unlink()
    with pytest.raises(InvalidInput, match="3 files"), output_folder(out):
        pytest.fail("the work was started")


def test_force_keeps_foreign_files_and_replaces_the_own_ones(out: Path) -> None:
    (out / "c" / "mine.c").write_text("mine")
    (out / "new.txt").write_text("mine too")
    (out / "empty").mkdir()
    (out / "link").symlink_to("c/mine.c")
    (out / "folder_link").symlink_to("c")
    run(out, True, report_html="two", new_txt="two")
    assert content(out) == {
        "report.html": "two",
        "new.txt": "two",
        "new.txt.kept": "mine too",
        "c/mine.c": "mine",
        "link": "mine",
    }
    assert (out / "empty").is_dir() and (out / "link").is_symlink() and alone(out)
    assert (out / "folder_link").is_symlink()
    # Kept files are still foreign: the next run refuses them, and keeps them with force.
    with pytest.raises(InvalidInput, match=r"new\.txt\.kept"), output_folder(out):
        pytest.fail("the work was started")
    run(out, True, new_txt="three")
    assert content(out) == {
        "new.txt": "three",
        "new.txt.kept": "mine too",
        "c/mine.c": "mine",
        "link": "mine",
    }


def test_foreign_files_that_appear_during_the_run_are_kept(out: Path) -> None:
    with output_folder(out) as folder:
        (folder / "a.txt").write_text("two")
        (out / "late.txt").write_text("mine")
    assert content(out) == {"a.txt": "two", "late.txt": "mine"} and foreign_files(out) == ["late.txt"]


def test_a_file_in_the_way_and_the_working_folder_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(InvalidInput, match="a file, expected a folder"), output_folder(tmp_path / "out"):
        pytest.fail("the work was started")
    monkeypatch.chdir(tmp_path)
    for path in (".", "..", tmp_path):
        with pytest.raises(InvalidInput, match="working folder"), output_folder(path, force=True):
            pytest.fail("the work was started")
    below = tmp_path / "out" / "below"
    with pytest.raises(InvalidInput), output_folder(below):
        pytest.fail("the work was started")


@pytest.mark.parametrize("name", ["a\0b", "n" * 5000, "n" * 300], ids=["NUL", "5000", "300"])
def test_a_name_that_no_folder_can_have_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidInput, match="name"), output_folder(tmp_path / name):
        pytest.fail("the work was started")
    assert foreign_files(tmp_path / name) == [] and list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_refused_at_once(
    out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(self: Path, *args: object, **kwargs: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(InvalidInput, match="Read-only file system"), output_folder(out):
        pytest.fail("the work was started")
    assert content(out) == FIRST and alone(out)


def test_a_full_disk_is_said_and_loses_nothing(out: Path) -> None:
    with pytest.raises(InvalidInput, match="No space left"), output_folder(out) as folder:
        (folder / "half.txt").write_text("half")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert content(out) == FIRST and alone(out)


def test_a_full_disk_is_said_of_the_place_that_the_user_named(
    out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the package's own writers meet it, in the folder that is not yet in place."""

    def full(self: Path, content: bytes) -> int:
        raise OSError(errno.ENOSPC, "No space left on device", str(self))

    monkeypatch.setattr(Path, "write_bytes", full)
    for name in ("results.json", "c/law.json"):
        with pytest.raises(InvalidInput, match="No space left") as caught, output_folder(out) as folder:
            save_json(folder / name, "results", {})
        assert caught.value.problem.where == str(out / name)
    with pytest.raises(InvalidInput) as caught, output_folder(out):
        pass  # the marker
    assert caught.value.problem.where == str(out / MANIFEST)
    with pytest.raises(InvalidInput) as caught, output_folder(out):
        raise InvalidInput("kp", "-1", "a positive number", "Check it.")
    assert caught.value.problem.where == "kp"
    assert content(out) == FIRST and alone(out)


@pytest.mark.parametrize("failing", [1, 2])
@pytest.mark.parametrize("error", [OSError(errno.EACCES, "Permission denied"), KeyboardInterrupt()])
def test_a_rename_that_fails_or_is_interrupted_puts_the_old_output_back(
    out: Path, monkeypatch: pytest.MonkeyPatch, failing: int, error: BaseException
) -> None:
    rename, calls = Path.rename, []

    def faulty(self: Path, target: Path) -> Path:
        # The marker is written by a replace, so these are the two renames of the swap, and the one back.
        calls.append(self)
        if len(calls) == failing:
            raise error
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", faulty)
    expected = InvalidInput if isinstance(error, OSError) else KeyboardInterrupt
    with pytest.raises(expected), output_folder(out) as folder:
        (folder / "a.txt").write_text("two")
    assert content(out) == FIRST and alone(out)


KILLED = """
import os, signal, sys
from pathlib import Path
from lostmotion.io.storage.folders import output_folder
if sys.argv[2] == "in the swap":
    rename = Path.rename
    def killed_after(self, target):
        rename(self, target)
        os.kill(os.getpid(), signal.SIGKILL)
    Path.rename = killed_after
with output_folder(sys.argv[1]) as folder:
    (folder / "report.html").write_text("half")
    if sys.argv[2] == "in the work":
        os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
@pytest.mark.parametrize("moment", ["in the work", "in the swap"])
def test_a_killed_run_loses_nothing_and_the_next_one_clears_up(out: Path, moment: str) -> None:
    done = subprocess.run([sys.executable, "-c", KILLED, str(out), moment], check=False)
    assert done.returncode == -signal.SIGKILL
    if moment == "in the work":
        assert content(out) == FIRST
    assert not alone(out)
    with pytest.raises(ValueError, match="stop"), output_folder(out):
        assert content(out) == FIRST
        raise ValueError("stop")
    assert content(out) == FIRST and alone(out)
    run(out, a_txt="three")
    assert content(out) == {"a.txt": "three"} and alone(out)


def test_the_folder_of_a_run_that_still_works_is_left_alone(out: Path) -> None:
    with output_folder(out) as first:
        (first / "a.txt").write_text("slow")
        run(out, a_txt="quick")
        assert first.is_dir()
    assert content(out) == {"a.txt": "slow"} and alone(out)


def test_a_link_to_a_folder_stays_a_link(out: Path, tmp_path: Path) -> None:
    link = tmp_path / "link"
    link.symlink_to(out)
    run(link, a_txt="two")
    assert link.is_symlink() and content(out) == {"a.txt": "two"}

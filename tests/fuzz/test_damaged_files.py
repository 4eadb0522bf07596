"""A thousand damaged files of every format: each is read, or refused with the package's own error, in time and memory.

``benchmarks/fuzz.py`` does the same with a hundred thousand.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("resource", reason="limits as on POSIX systems")

from fuzz_formats import FORMATS, Format
from fuzz_limits import fault

#: Where damage is no error: what these hold is worked out again, and a folder without its manifest is the user's.
COUNT_AS_NONE = ("manifest", "chunk of a batch", "scores", "leaderboard.json")
#: Files of each format in one test.
EACH = 1000


@pytest.mark.parametrize("kind", FORMATS, ids=lambda kind: kind.name)
def test_damaged_files_are_read_or_refused(tmp_path: Path, kind: Format) -> None:
    path = tmp_path / kind.file_name
    found = {}
    for number in range(EACH):
        path.write_bytes(kind.mutation(number))
        if what := fault(lambda: kind.read(path)):
            found[number] = what
    assert not found, (
        f"python benchmarks/fuzz.py --format {kind.name!r} --first {min(found)} --count 1: {found}"
    )


@pytest.mark.parametrize("kind", FORMATS, ids=lambda kind: kind.name)
def test_the_sound_examples_are_read(tmp_path: Path, kind: Format) -> None:
    for example in kind.examples():
        (tmp_path / kind.file_name).write_bytes(example)
        if kind.name == "TOML":
            assert kind.read(tmp_path / kind.file_name).recordings
        else:
            assert kind.read(tmp_path / kind.file_name) is not None


@pytest.mark.parametrize("kind", FORMATS, ids=lambda kind: kind.name)
def test_a_good_part_of_the_damage_is_refused(tmp_path: Path, kind: Format) -> None:
    """Else the mutations would not reach the reader; and two in a row are not the same."""
    from lostmotion.errors import LostMotionError

    path, refused = tmp_path / kind.file_name, 0
    mutations = [kind.mutation(number) for number in range(60)]
    for data in mutations:
        path.write_bytes(data)
        try:
            kind.read(path)
        except LostMotionError:
            refused += 1
    assert refused >= (0 if kind.name in COUNT_AS_NONE else 15)
    assert len(set(mutations)) > 50 and kind.mutation(7) == kind.mutation(7)


def endless() -> None:
    while True:
        pass


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda: int("x"), "ValueError"),
        (lambda: bytearray(2 * 10**9), "takes more than 1 GB"),
        (endless, "takes more than 0.5 s"),
        (lambda: None, ""),
    ],
    ids=["a foreign error", "memory", "time", "none"],
)
def test_what_is_wrong_is_seen(call: object, expected: str) -> None:
    assert fault(call, seconds=0.5) == expected  # type: ignore[arg-type]


def test_the_benchmark_finds_a_file_by_its_number(tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "benchmarks" / "fuzz.py"
    before = time.monotonic()
    done = subprocess.run(
        [sys.executable, script, "--format", "drivetrain.toml", "--first", "3", "--count", "2"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "| drivetrain.toml | 2 | 0 |" in done.stdout and time.monotonic() - before < 60.0

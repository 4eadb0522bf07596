"""Kept scores: what they belong to, and when they are no longer believed."""

from __future__ import annotations

import shutil
import tomllib
from pathlib import Path

import pytest

import lostmotion
from lostmotion.compare import compare_observers, score_cache
from lostmotion.compare.score_cache import ABOVE, COMPARED, TABLES, ScoreCache, source_hash
from lostmotion.errors import InvalidInput

PACKAGE = Path(lostmotion.__file__).parent
FOUND = {"Observer 1": {"speed_load": 0.1, "f1_gap": None}}


@pytest.fixture
def changed(tmp_path):
    """Whether the hash changes with a comment in a file of the package."""
    copy = tmp_path / "lostmotion"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))

    def hash_changes(name):
        source_hash.cache_clear()
        before = source_hash(copy)
        assert (copy / name).is_file()
        with (copy / name).open("a") as file:
            file.write("# changed\n")
        source_hash.cache_clear()
        return source_hash(copy) != before

    yield hash_changes
    source_hash.cache_clear()


@pytest.mark.parametrize(
    "name",
    ["observers/fixed_gain/kalman", "kernels/plant/event_loop", "compare/experiment",
     "compare/contestants", "compare/scores", "compare/jobs", "compare/score_observers",
     "compare/controllers/contestants", "compare/controllers/scores", "controllers/lqi",
     "rig/nominal", "simulation/sensors", "identification/prediction_error/identify", "systems/__init__",
     "drivetrain/__init__", "curves"],
)  # fmt: skip
def test_a_score_depends_on(changed, name):
    assert changed(f"{name}.py")


@pytest.mark.parametrize("name", ["cli/main_job", "plot/observers/leaderboard", "compare/leaderboard"])
def test_no_score_depends_on(changed, name):
    assert not changed(f"{name}.py")


def test_a_new_file_counts(tmp_path):
    (tmp_path / "observers").mkdir()
    (tmp_path / "curves.py").write_text("")
    hashes = []
    for action in (lambda: None, lambda: (tmp_path / "observers" / "new.py").write_text("")):
        action()
        source_hash.cache_clear()
        hashes.append(source_hash(tmp_path))
    assert hashes[0] != hashes[1]


def test_what_is_left_out_lies_above_all_that_is_judged():
    """The layers forbid the rig and all below it to import these; so no score can depend on them."""
    file = PACKAGE.parents[1] / "pyproject.toml"
    if not file.is_file():
        pytest.skip("not run from the sources")
    layers = tomllib.loads(file.read_text())["tool"]["importlinter"]["contracts"][0]["layers"]
    above = layers[: next(i for i, layer in enumerate(layers) if "rig" in layer.split(" | "))]
    assert set(ABOVE) == {name for layer in above for name in layer.split(" | ")} - {"compare"}
    assert all((PACKAGE / f"{name}.py").is_file() for name in (*TABLES, *COMPARED))


def test_what_is_compared_from_above_counts_and_hangs_on_nothing_else_there(tmp_path):
    for name in COMPARED:
        text = (PACKAGE / f"{name}.py").read_text()
        assert not any(f"from ..{room}" in text for room in ABOVE) and "from ." not in text.replace(
            "from ..", ""
        )
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / f"{name}.py").write_text("")
        (tmp_path / f"{name}_else.py").write_text("")
        source_hash.cache_clear()
        first = source_hash(tmp_path)
        (tmp_path / f"{name}_else.py").write_text("changed")
        source_hash.cache_clear()
        assert source_hash(tmp_path) == first
        (tmp_path / f"{name}.py").write_text("changed")
        source_hash.cache_clear()
        assert source_hash(tmp_path) != first
    source_hash.cache_clear()


def test_other_code_starts_over_the_same_code_goes_on(tmp_path, monkeypatch):
    ScoreCache(tmp_path, "long").add("nominal", 1, FOUND)
    assert ScoreCache(tmp_path, "long").scores("nominal", 1) == FOUND
    monkeypatch.setattr(score_cache, "source_hash", lambda: "other")
    assert ScoreCache(tmp_path, "long").scores("nominal", 1) == {}


def test_another_duration_has_files_of_its_own(tmp_path):
    ScoreCache(tmp_path, "long").add("nominal", 1, FOUND)
    short = ScoreCache(tmp_path, "short")
    assert short.scores("nominal", 1) == {}
    short.add("nominal", 1, {"Observer 1": {"speed_load": 0.2}})
    assert ScoreCache(tmp_path, "long").scores("nominal", 1) == FOUND


def test_without_a_folder_nothing_is_written():
    cache = ScoreCache(None)
    cache.add("nominal", 1, FOUND)
    assert cache.scores("nominal", 1) == FOUND and cache.folder is None


def test_a_folder_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InvalidInput, match="file"):
        compare_observers(tmp_path / "file", quick=True)

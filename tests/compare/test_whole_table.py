"""Which table of a folder is replaced, and which is kept."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

from lostmotion.compare import CASES, CONTESTANTS, Leaderboard, compare_observers
from lostmotion.compare.whole_table import keep_whole_table
from lostmotion.errors import InvalidInput

EVERYONE = {entry.name: entry.kind for entry in CONTESTANTS}
QUICK = tuple(case for case in CASES if case.quick)


def table(observers=EVERYONE, cases=CASES, seeds=(1, 2, 3), duration=3.0, part=False):
    scores = {case.name: {seed: {} for seed in seeds} for case in cases}
    return Leaderboard(observers, cases, seeds, scores, {"duration": duration, "quick": False, "part": part})


WHOLE = table()


def keep(folder, new):
    keep_whole_table(folder, new, "observers", EVERYONE, [case.name for case in CASES])


@pytest.mark.parametrize(
    "new, lost",
    [
        (table({"Observer 1": "fixed gain"}), f"{len(EVERYONE) - 1} of its observers"),
        (table(cases=QUICK), f"{len(CASES) - len(QUICK)} of its cases"),
        (table(seeds=(1, 2)), "1 of its rigs"),
        (table(duration=1.5), "its longer recordings"),
    ],
)
def test_the_whole_table_is_kept(tmp_path, new, lost):
    WHOLE.write(tmp_path)
    with pytest.raises(InvalidInput, match=f"would lose {lost}, expected.*--force"):
        keep(tmp_path, new)


@pytest.mark.parametrize("new", [WHOLE, table(seeds=(1, 2, 3, 4)), table(duration=4.0)])
def test_a_table_of_the_same_or_more_takes_its_place(tmp_path, new):
    WHOLE.write(tmp_path)
    keep(tmp_path, new)


def test_a_part_may_be_replaced_and_what_is_no_table_is_nothing_to_keep(tmp_path):
    small = table({"Observer 1": "fixed gain"}, cases=QUICK, part=True)
    keep(tmp_path, small)
    table(part=True).write(tmp_path)
    keep(tmp_path, small)
    for content in ("", "[]", "{}", '{"settings": 5}'):
        (tmp_path / "leaderboard.json").write_text(content)
        keep(tmp_path, small)


def test_a_table_from_before_parts_were_marked_counts_as_whole_and_names_that_are_gone_as_nothing(tmp_path):
    WHOLE.write(tmp_path)
    old = json.loads((tmp_path / "leaderboard.json").read_text())
    del old["settings"]["part"]
    old["observers"].append({"name": "an observer that was renamed"})
    (tmp_path / "leaderboard.json").write_text(json.dumps(old))
    keep(tmp_path, WHOLE)
    with pytest.raises(InvalidInput, match="1 of its rigs"):
        keep(tmp_path, replace(WHOLE, seeds=(1, 2)))


def test_it_is_refused_before_any_work(tmp_path):
    WHOLE.write(tmp_path)
    with pytest.raises(InvalidInput, match="would lose"):
        compare_observers(tmp_path, cases=["nominal"])
    assert not (tmp_path / "scores").exists()

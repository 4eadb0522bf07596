"""The zoo's page shows what the kept results of the test drives say."""

from __future__ import annotations

import sys
from pathlib import Path

import lostmotion as lm

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))
import shared
import zoo_shares
import zoo_tables
import zoo_targets

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "benchmarks" / "zoo.md").read_text()
RESULTS = shared.read(ROOT / "benchmarks" / "results" / "zoo-test.jsonl.gz")


def test_its_tables_are_those_of_the_results() -> None:
    scores = zoo_tables.Scores(RESULTS)
    targets = zoo_targets.target_table(zoo_targets.target_lines(scores))
    assert "\n".join(targets) in PAGE
    assert "\n".join(zoo_tables.parameter_table(scores)) in PAGE
    assert "\n".join(zoo_shares.share_table(scores)) in PAGE
    assert f"{len(RESULTS)} drives" in PAGE


def test_each_test_drive_counts_once() -> None:
    seeds = [entry["seed"] for entry in RESULTS]
    assert len(set(seeds)) == len(seeds) and {*seeds} <= {*lm.rig.SETS["test"]}

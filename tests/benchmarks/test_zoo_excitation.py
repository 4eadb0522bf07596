"""What the benchmark of designed tests makes of its lines, and which drives it takes."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "benchmarks"))
import zoo_excitation


def line(predicted: dict[str, float], found: dict[str, tuple[float, float, bool]]) -> dict[str, object]:
    names = ("half", "error", "holds")
    return {
        "predicted": predicted,
        "found": {name: dict(zip(names, values, strict=True)) for name, values in found.items()},
    }


def test_widths_are_compared_where_both_are_known():
    table = zoo_excitation.table(
        [
            line({"stiffness": 0.02}, {"stiffness": (0.01, -0.005, True)}),
            line({}, {"stiffness": (0.01, 0.03, False)}),
            line({"stiffness": 0.02}, {}),
        ]
    )
    (row,) = [one for one in table.splitlines() if one.startswith("| stiffness")]
    assert row == "| stiffness | 2 of 3 | 1 | 1 | 0.50, 0.50, 0.50 | 1.8 | 1 of 2 |"


def test_a_drive_without_one_gap_is_left_out():
    assert zoo_excitation.played(1, 1.5) is None  # rigid

"""The bound "no backlash above": how often it is given, whether it holds, and over what the Cramér–Rao limit allows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from lostmotion.identification import Identification


def gap_bound(found: Identification) -> float | None:
    """The bound, rad; None where none is given, or the backlash is identified."""
    if found.sources["backlash"] == "identified" or "backlash" not in found.intervals:
        return None
    return found.intervals["backlash"][1]


def gap_bound_numbers(entries: Sequence[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Figures of the flexible drives without a gap, and of those with one."""
    flexible = [entry for entry in entries if not entry["absent"] and "gap_bound" in entry]
    groups: dict[str, list[dict[str, Any]]] = {"without": [], "with": []}
    for entry in flexible:
        groups["with" if entry["truth"]["backlash"] > 0.0 else "without"].append(entry)
    return {name: _numbers(group) for name, group in groups.items()}


def _numbers(entries: Sequence[dict[str, Any]]) -> dict[str, float]:
    given = [entry for entry in entries if entry["gap_bound"] is not None]
    # Of a drive without a gap the limit is in rad.
    without = [entry for entry in given if entry["truth"]["backlash"] == 0.0]
    ratios = [entry["gap_bound"] / entry["bound"]["backlash"] for entry in without]
    return {
        "drives": len(entries),
        "given": len(given),
        "holds": sum(entry["truth"]["backlash"] <= entry["gap_bound"] for entry in given),
        "identified": sum("backlash" in entry["found"] for entry in entries),
        "ratio_median": float(np.median(ratios)) if ratios else np.nan,
    }


def gap_bound_table(numbers: dict[str, dict[str, float]]) -> list[str]:
    """The same as Markdown."""
    lines = [
        '"No backlash above": how often it is given and holds, and its median over the Cramér–Rao half width.',
        "",
        "| drives | | bound given | holds | a gap identified | over Cramér–Rao, median |",
        "|---" * 6 + "|",
    ]
    for name, n in numbers.items():
        counts = " | ".join(str(n[key]) for key in ("drives", "given", "holds", "identified"))
        lines.append(f"| {name} a gap | {counts} | {n['ratio_median']:.3g} |")
    return lines

"""The targets of identification on random drives, each beside what the results say."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from zoo_tables import COUNTS, Scores, low_cells, numbers, quantile, summary

#: Encoders of the target group have so many bits at least; an analog sensor is in it (option: the target).
BITS = 16
#: A drive counts for errors of a few percent if its Cramér–Rao half width is no more than this.
COUNTS_FINE = 0.03
#: Share of drives on which a value is identified, at least, in the target group (option: the target).
IDENTIFIED = {"inertia_motor": 0.95, "inertia_load": 0.95, "stiffness": 0.90, "backlash": 0.90}
#: Nine in ten errors are below this; half of the backlash's are below the second (option: the target).
ERROR_90, BACKLASH_MEDIAN = 0.03, 0.005
#: Seconds for one drive at most (option: the target).
LONGEST = 20.0

#: What is asked, the target, what was measured, of how many, and whether it is met.
Line = tuple[str, str, str, int, bool]


def in_target_group(entry: dict[str, Any]) -> bool:
    """Whether its excitation is designed, it has a gap, and its sensor is no coarse encoder."""
    kind = entry["dimensions"]
    return (
        kind["excitation"] == "designed" and kind["gap"] > 0.0 and (kind["bits"] == 0 or kind["bits"] >= BITS)
    )


def target_lines(scores: Scores) -> list[Line]:
    """One line for each target; one drive at least."""
    whole = summary(scores)
    pooled, gaps = whole["pooled"], whole["gap_bound"]
    values = int(pooled["values"])
    lines: list[Line] = [
        _between("coverage, %", 93.0, 98.0, 100.0 * pooled["coverage"], values),
        _at_most("parameters and quartiles with too low a coverage", 0, len(low_cells(scores)), values),
        _at_most("grossly wrong, %", 0.5, 100.0 * pooled["gross"], values),
    ]
    group = scores.of(in_target_group)
    for name, least in IDENTIFIED.items():
        rows = [row for row in group.named(name) if row.counts]
        share = 100.0 * numbers(rows)["identified"]
        lines.append(_at_least(f"{name} identified, target group, %", 100.0 * least, share, len(rows)))
    designed = scores.of(lambda entry: entry["dimensions"]["excitation"] == "designed")
    for name in IDENTIFIED:
        errors = _errors(designed, name, COUNTS_FINE)
        most = 100.0 * quantile(errors, 0.9)
        lines.append(_at_most(f"{name}, 90 % of errors, designed, %", 100.0 * ERROR_90, most, len(errors)))
    errors = _errors(designed, "backlash", COUNTS)
    half = 100.0 * quantile(errors, 0.5)
    lines.append(_at_most("backlash, median error, designed, %", 100.0 * BACKLASH_MEDIAN, half, len(errors)))
    lines.append(_at_most("half width over error, median", 6.0, pooled["half_over_error"], values))
    given = gaps["without"]["given"]
    holds = 100.0 * gaps["without"]["holds"] / given if given else np.nan
    lines.append(_at_least("no gap: bounds that hold, %", 95.0, holds, given))
    lines.append(
        _at_most("no gap: bound over Cramér–Rao, median", 3.0, gaps["without"]["ratio_median"], given)
    )
    for which, n in whole["observer"].items():
        of = "" if which == "all" else f", {which}"
        fine = 100.0 * n["fine_identified"]
        lines.append(_at_least(f"Observer 1 within 0.5 % of range{of}, %", 90.0, fine, n["drives"]))
        lines.append(
            _at_most(f"Observer 1 over that with true values{of}, 90 %", 1.3, n["ratio_90"], n["drives"])
        )
    times = [entry["time"] <= LONGEST for entry in scores.entries]
    lines.append(
        _at_least(f"drives within {LONGEST:g} s, %", 100.0, 100.0 * float(np.mean(times)), len(times))
    )
    return lines


def target_table(lines: Sequence[Line]) -> list[str]:
    """The same as Markdown."""
    shown = ["| | target | measured | of | met |", "|---" * 5 + "|"]
    return shown + [f"| {a} | {t} | {m} | {n} | {'yes' if met else '**no**'} |" for a, t, m, n, met in lines]


def _errors(scores: Scores, name: str, bound: float) -> list[float]:
    """Relative, of what is identified where the Cramér–Rao half width is no more than the bound."""
    return [row.error for row in scores.named(name) if row.identified and row.bound <= bound]


def _at_most(text: str, most: float, measured: float, count: int) -> Line:
    return text, f"≤ {most:g}", f"{measured:.3g}", count, bool(measured <= most)


def _at_least(text: str, least: float, measured: float, count: int) -> Line:
    return text, f"≥ {least:g}", f"{measured:.3g}", count, bool(measured >= least)


def _between(text: str, least: float, most: float, measured: float, count: int) -> Line:
    return text, f"{least:g} … {most:g}", f"{measured:.3g}", count, bool(least <= measured <= most)

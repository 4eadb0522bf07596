"""The controllers' leaderboard and all pages that quote it: python docs/make_controller_leaderboard.py FOLDER

Computes what is missing in the folder (``compare_controllers``: 20 rigs, ten minutes on two quiet cores; it goes on
where it was stopped), then writes the figure, the tables of the benchmark's page, and the parts between ``<!-- … -->``
marks of the leaderboard's page and of the page on choosing.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from datetime import date
from pathlib import Path
from typing import Any

from lostmotion.compare import compare_controllers
from lostmotion.plot.controllers.leaderboard import controller_leaderboard

DOCS = Path(__file__).parent
BOUNDED, TOLERANT = "soft landing, bounded", "soft landing, tolerant"
FAST, POLES, PI = "soft landing, fast", "pole placement", "PI, Table II"
HYBRID = "hybrid predictive"
ADAPTIVE = "adaptive soft landing"
RAMP, LANDED = "ramp 400 Nm/s, active damping", "ramp, active damping, soft landing"
RESTS = tuple(f"rest, friction model × {f}" for f in ("0.8", "1", "1.5"))
INERTIAS = tuple(f"load inertia × {f}" for f in ("0.5", "2", "3"))
GAPS = ("known backlash −20 %", "known backlash +20 %")

Row = tuple[str, str, str, bool]


class Numbers:
    """Median and worst of the table."""

    def __init__(self, table: Mapping[str, Any]) -> None:
        self.cases = {case["name"]: case["controllers"] for case in table["cases"]}

    def median(self, law: str, metric: str, *cases: str) -> float:
        """The largest median of the cases."""
        return max(self.cases[case][law][metric][0] for case in cases or ("step",))

    def worst(self, law: str, metric: str, *cases: str) -> float:
        return max(self.cases[case][law][metric][3] for case in cases or ("step",))

    def text(self, law: str, metric: str, *cases: str, factor: float = 1.0) -> str:
        middle, worst = (f(law, metric, *cases) * factor for f in (self.median, self.worst))
        return f"{middle:.3g} ({worst:.3g})"


def targets(n: Numbers) -> list[Row]:
    """Target, law, what was measured, whether the median keeps it."""

    def share(words: str, metric: str, part: float, factor: float = 1.0, most: float = float("inf")) -> Row:
        limit = min(part * n.median(POLES, metric), most)
        found = n.text(BOUNDED, metric, factor=factor)
        text = f"{found} against {factor * limit:.3g}"
        return words, BOUNDED, text, n.median(BOUNDED, metric) <= limit

    def below(words: str, law: str, metric: str, most: float, *cases: str, factor: float = 1.0) -> Row:
        return words, law, n.text(law, metric, *cases, factor=factor), n.median(law, metric, *cases) <= most

    def higher(words: str, metric: str) -> Row:
        least = n.median(PI, metric)
        return words, POLES, f"{n.text(POLES, metric)} against {least:.3g}", n.median(POLES, metric) > least

    saved = 1.0 - n.median(LANDED, "arrival_time", "tip-in") / n.median(RAMP, "arrival_time", "tip-in")
    kept = n.median(POLES, "impact_speed", *GAPS)
    return [
        ("PI overshoots by 5 % or more", PI, n.text(PI, "overshoot"), n.median(PI, "overshoot") >= 5.0),
        below("pole placement by 2 % at most", POLES, "overshoot", 2.0),
        higher("pole placement's peak torque, Nm, is higher than PI's", "peak_torque"),
        higher("so is its motor oscillation, rad/s", "oscillation"),
        share("t90, ms, at most 1.1 × pole placement's", "arrival_time", 1.1, 1e3),
        share("rise, ms, at most pole placement's", "rise_time", 1.0, 1e3),
        below("overshoot, %, at most 1", BOUNDED, "overshoot", 1.0),
        share("impact, rad/s, at most a quarter of it, and 1", "impact_speed", 0.25, most=1.0),
        share("oscillation, rad/s, at most half of it", "oscillation", 0.5),
        share("motor – set-point after 90 %, at most 0.6 of it", "motor_deviation", 0.6),
        share("motor beyond set-point, rad/s, at most 0.6 of it", "motor_overshoot", 0.6),
        below("peak torque, Nm, at most 73.5", BOUNDED, "peak_torque", 73.5),
        below("steady error, %, at most 0.1", BOUNDED, "steady_error", 1e-3, "step", "load step", factor=100.0),
        below("back after −10 Nm, ms, within 60", BOUNDED, "recovery_time", 0.06, "load step", factor=1e3),
        (
            "tip-in: t90, ms, 60 % below a ramp of equal jerk", LANDED,
            f"{n.text(LANDED, 'arrival_time', 'tip-in', factor=1e3)}, {100.0 * saved:.0f} %", saved >= 0.6,
        ),
        below("tip-in: jerk, krad/s³, at most 45", LANDED, "load_jerk", 45e3, "tip-in", factor=1e-3),
        below("tip-in: time in the gap, ms, at most 10", LANDED, "lash_time", 0.010, "tip-in", factor=1e3),
        below("tip-in: impact, rad/s, at most 0.6", LANDED, "impact_speed", 0.6, "tip-in"),
        below("rest: load speed, rad/s, exactly 0", BOUNDED, "rest_speed", 0.0, *RESTS),
        below("rest: torque ripple, Nm, at most 1.5", BOUNDED, "ripple", 1.5, *RESTS),
        below("load inertia × 0.5 to 3: overshoot, %, at most 15", ADAPTIVE, "overshoot", 15.0, *INERTIAS),
        below("the same at most 8", ADAPTIVE, "overshoot", 8.0, *INERTIAS),
        below("the same: share of unstable runs, 0", ADAPTIVE, "unstable", 0.0, *INERTIAS),
        (
            "backlash ±20 %: impact, rad/s, at most pole placement's", BOUNDED,
            f"{n.text(BOUNDED, 'impact_speed', *GAPS)} against {kept:.3g}",
            n.median(BOUNDED, "impact_speed", *GAPS) <= kept,
        ),
        below("near the bound: t90, ms, at most 12.9", FAST, "arrival_time", 0.0129, factor=1e3),
        below("near the bound: impact, rad/s, at most 0.5", FAST, "impact_speed", 0.5),
    ]  # fmt: skip


def target_table(n: Numbers) -> str:
    rows = ["| target | law | measured | met |", "|---|---|---|---|"]
    rows += [
        f"| {words} | {law} | {text} | {'yes' if met else '**no**'} |" for words, law, text, met in targets(n)
    ]
    return "\n".join(rows)


def situation_table(n: Numbers) -> str:
    """Speed laws by what is wrong with the model."""
    situations = [
        ("drive as identified", BOUNDED, ("step",)),
        ("the same, the motor may run ahead", TOLERANT, ("step",)),
        ("the same, as fast as it goes", FAST, ("step",)),
        ("the same, nothing may swing", "flat, 300 rad/s²", ("step",)),
        ("the same, soft limits of twist or torque", HYBRID, ("step",)),
        ("backlash known to ±20 %", BOUNDED, GAPS),
        ("load inertia × 0.5 to 3", ADAPTIVE, INERTIAS),
        ("no observer", "PI, optimised, friction", ("step",)),
        ("for comparison: pole placement, −400 1/s", POLES, ("step",)),
        ("for comparison: PI, Table II", PI, ("step",)),
    ]
    rows = ["| situation | take | t90, ms | overshoot, % | impact, rad/s |", "|---|---|---|---|---|"]
    for words, law, cases in situations:
        cells = (
            n.text(law, "arrival_time", *cases, factor=1e3), n.text(law, "overshoot", *cases),
            n.text(law, "impact_speed", *cases),
        )  # fmt: skip
        rows.append(
            f"| {words} | {'' if words.startswith('for comparison') else law} | {' | '.join(cells)} |"
        )
    return "\n".join(rows)


def torque_table(n: Numbers) -> str:
    rows = [
        "| a torque is asked for, −10 → 20 Nm | t90, ms | jerk of the load, krad/s³ | impact, rad/s | lash, ms |",
        "|---|---|---|---|---|",
    ]
    columns = {"arrival_time": 1e3, "load_jerk": 1e-3, "impact_speed": 1.0, "lash_time": 1e3}
    for law in (RAMP, LANDED):
        cells = " | ".join(n.text(law, metric, "tip-in", factor=f) for metric, f in columns.items())
        rows.append(f"| {law} | {cells} |")
    return "\n".join(rows)


#: Page, mark, what stands there.
PARTS: tuple[tuple[str, str, Callable[[Numbers], str]], ...] = (
    ("controller-leaderboard.md", "targets", target_table),
    ("choosing-a-controller.md", "situations", situation_table),
    ("choosing-a-controller.md", "torque", torque_table),
)


def replaced(page: str, mark: str, text: str) -> str:
    """The page with the text between the marks."""
    found, count = re.subn(
        rf"(<!-- {mark} -->\n).*?(\n<!-- end of {mark} -->)",
        lambda m: m[1] + text + m[2],
        page,
        flags=re.DOTALL,
    )
    if count != 1:
        raise SystemExit(f"The page has {count} marks '{mark}', not one.")
    return found


def main() -> None:
    folder = Path(sys.argv[1])
    table = compare_controllers(
        folder, progress=lambda done, text: print(f"{100.0 * done:5.1f} %  {text}", flush=True)
    )
    data = table.to_dict()
    for name, mark, made in PARTS:
        page = DOCS / name
        page.write_text(replaced(page.read_text(), mark, made(Numbers(data))))
    full = DOCS / "benchmarks" / "controllers.md"
    head = f"{len(data['cases'])} cases, {len(data['seeds'])} rigs or drives of the zoo, {date.today():%Y-%m-%d}."
    full.write_text(replaced(full.read_text(), "tables", f"{head} {table.to_markdown().strip()}"))
    controller_leaderboard(data).savefig(
        DOCS / "images" / "controller-leaderboard.png", dpi=70, facecolor="white"
    )


if __name__ == "__main__":
    main()

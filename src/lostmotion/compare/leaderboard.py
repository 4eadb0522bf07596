"""The leaderboard: scores by case, seed and observer, and the tables made of them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..version import VERSION
from .cases import CASES, Case
from .contestants import REFERENCE
from .score_table import ScoreTable, plain
from .scores import FAILED, METRICS
from .statistics import FEWEST_SEEDS, Estimate, log_ratio, overall, ratio, verdict

#: Groups of cases in one table, so that it fits on a screen (option).
SCREEN = 4

#: Signal of the ranking and the wins.
RANKED_BY = "speed_load"
_PERCENT = ("speed_load", "torque_shaft", "twist_elastic", "backlash_error")


class Leaderboard(ScoreTable[Case]):
    """Scores of all observers over all cases and seeds."""

    ENTRY = "observer"
    METRICS = METRICS

    def against_reference(self, observer: str, case: str, metric: str = RANKED_BY) -> Estimate | None:
        """Error divided by that of Observer 1 on the same recordings: median over seeds."""
        return ratio(self.values(observer, case, metric), self.values(REFERENCE, case, metric))

    def needs_torque_sensor(self, observer: str) -> bool:
        """Whether the observer reads the shaft's torque sensor: few drives have one."""
        rows = [row for seeds in self.scores.values() for row in seeds.values()]
        return any(row.get(observer, {}).get("torque_sensor") for row in rows)

    def counted(self, observer: str) -> tuple[Case, ...]:
        """Cases that count for the observer: not those that only change a sensor that it does not read."""
        reads = self.needs_torque_sensor(observer)
        return tuple(case for case in self.cases if reads or not _torque_sensor_alone(case))

    def overall(self, observer: str, metric: str = RANKED_BY) -> Estimate | None:
        """Geometric mean of that ratio over the counted cases of each group, then over groups.

        So a group of sixteen cases has the weight of one. An error from ``FAILED`` on counts as ``FAILED``: how badly
        an observer fails does not decide.
        """
        table: dict[str, dict[str, dict[int, float]]] = {}
        for case in self.counted(observer):
            own, reference = (self.values(o, case.name, metric) for o in (observer, REFERENCE))
            common = set(own) & set(reference)
            if common:
                table.setdefault(case.group, {})[case.name] = {
                    s: log_ratio(min(own[s], FAILED), min(reference[s], FAILED)) for s in common
                }
        return overall(table)

    def wins(self, observer: str, metric: str = RANKED_BY) -> dict[str, int] | None:
        """Number of counted cases won, tied and lost against Observer 1; None for too few rigs."""
        counts = {"win": 0, "tie": 0, "loss": 0}
        for case in self.counted(observer):
            own, reference = (self.values(o, case.name, metric) for o in (observer, REFERENCE))
            outcome = verdict(ratio(own, reference), len(set(own) & set(reference)))
            if outcome in counts:
                counts[outcome] += 1
        return counts if any(counts.values()) else None

    def times_per_sample(self, observer: str) -> dict[float, float]:
        """Smallest processor time per sample over all runs (s), by sample time (s)."""
        times: dict[float, float] = {}
        for case in (c for c in self.cases if c.drive == "rig"):
            for spent in self.values(observer, case.name, "time_per_sample").values():
                times[case.dt] = min(spent, times.get(case.dt, math.inf))
        return times

    def time_per_sample(self, observer: str) -> float | None:
        """That time at the first case's sample time, s."""
        return self.times_per_sample(observer).get(self.cases[0].dt)

    def largest_time_per_sample(self, observer: str) -> float | None:
        """That time at the sample time where it is largest, s: some filters predict a long sample in sub-steps."""
        return max(self.times_per_sample(observer).values(), default=None)

    def ranking(self) -> list[str]:
        """Observers from the best to the worst by ``overall``."""
        places = {name: self.overall(name) for name in self.entries}
        return sorted(self.entries, key=lambda n: places[n].value if places[n] is not None else math.inf)  # type: ignore[union-attr]

    def worst_of_group(self, observer: str, group: str, metric: str) -> float | None:
        """The largest median of the group's cases (for F1 the smallest)."""
        found = [self.median(observer, c.name, metric) for c in self.cases if c.group == group]
        medians = [f.value for f in found if f is not None]
        if not medians:
            return None
        return min(medians) if metric in ("f1_gap", "impacts_found") else max(medians)

    def to_dict(self) -> dict[str, Any]:
        """Everything, for JSON."""
        return {
            "schema": 2,
            "version": VERSION,
            "settings": dict(self.settings),
            "seeds": list(self.seeds),
            "reference": REFERENCE,
            "observers": [
                {
                    "name": name,
                    "kind": self.entries[name],
                    "needs_torque_sensor": self.needs_torque_sensor(name),
                    "overall_ratio": plain(self.overall(name)),
                    "wins": self.wins(name),
                    "wins_torque_shaft": self.wins(name, "torque_shaft"),
                    "time_per_sample": self.time_per_sample(name),
                    "largest_time_per_sample": self.largest_time_per_sample(name),
                }
                for name in self.ranking()
            ],
            "cases": [
                {
                    "name": case.name,
                    "group": case.group,
                    "column": self.column(case.group),
                    "observers": {
                        name: {
                            "ratio_to_reference": plain(self.against_reference(name, case.name)),
                            **{m: plain(self.median(name, case.name, m)) for m in METRICS},
                        }
                        for name in self.entries
                    },
                }
                for case in self.cases
            ],
        }

    def to_markdown(self) -> str:
        """Ranking, tables of the load speed by group of cases and on any drive, and a table of the nominal case."""
        parts = [self.ranking_table(), self._group_tables(), self.zoo_table(), self._nominal_table()]
        return "\n\n".join(filter(None, parts)) + "\n"

    def ranking_table(self) -> str:
        """Markdown."""
        lines = [
            "| observer | kind | torque sensor | error / Observer 1 (95 %) | wins – ties – losses | µs | µs at most |",
            "|---|---|---|---|---|---|---|",
        ]
        for name in self.ranking():
            found, wins = self.overall(name), self.wins(name)
            place = "–" if found is None else f"{found.value:.2f} ({found.low:.2f} to {found.high:.2f})"
            count = " – ".join(map(str, wins.values())) if wins and name != REFERENCE else "–"
            times = " | ".join(map(_micro, (self.time_per_sample(name), self.largest_time_per_sample(name))))
            sensor = "yes" if self.needs_torque_sensor(name) else "no"
            lines.append(f"| {name} | {self.entries[name]} | {sensor} | {place} | {count} | {times} |")
        return "\n".join([*lines, "", *self._remarks()])

    def _remarks(self) -> list[str]:
        """Notes to the ranking."""
        lines = [
            "Error of the load speed: geometric mean over the cases of each group, then over groups. Wins by case.",
            "Time per sample of a whole run, at the nominal sample time and at the one where it is largest.",
        ]
        left_out = [case.name for case in self.cases if _torque_sensor_alone(case)]
        if left_out:
            lines.append(f"Only for observers that read the torque sensor: {', '.join(left_out)}.")
        if len(self.seeds) < FEWEST_SEEDS:
            lines.append(f"Fewer than {FEWEST_SEEDS} rigs: no wins and losses.")
        return lines

    def column(self, group: str) -> str:
        """Heading of the group's column: a single case by its own name."""
        cases = [case.name for case in self.cases if case.group == group]
        several = sum(case.group == group for case in CASES) > 1
        return cases[0] if len(cases) == 1 and several else group

    def _group_tables(self) -> str:
        groups = tuple(dict.fromkeys(case.group for case in self.cases if case.drive == "rig"))
        parts = [groups[i : i + SCREEN] for i in range(0, len(groups), SCREEN)]
        if not groups:
            return ""
        return "\n\n".join(
            ["Load speed, RMSE in % of range, worst case of each group:", *map(self._group_table, parts)]
        )

    def _group_table(self, groups: tuple[str, ...]) -> str:
        heads = [self.column(group) for group in groups]
        lines = ["| observer | " + " | ".join(heads) + " |", "|---" * (len(groups) + 1) + "|"]
        for name in self.ranking():
            cells = [_percent(self.worst_of_group(name, group, RANKED_BY)) for group in groups]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
        return "\n".join(lines)

    def zoo_table(self) -> str:
        """Drives of the zoo, Markdown, with the worst drive too, since no two are alike; empty without such cases."""
        cases = [case.name for case in self.cases if case.drive != "rig"]
        if not cases:
            return ""
        lines = [
            "Load speed on drives of the zoo, RMSE in % of range: median, and in brackets the worst drive, or on how",
            f"many the observer failed (it cannot be made, or has {100.0 * FAILED:.0f} % and more):",
            "",
            "| observer | " + " | ".join(cases) + " |",
            "|---" * (len(cases) + 1) + "|",
        ]
        for name in self.ranking():
            cells = [self._zoo_cell(name, case) for case in cases]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
        return "\n".join(lines)

    def _zoo_cell(self, observer: str, case: str) -> str:
        errors = list(self.values(observer, case, RANKED_BY).values())
        failed = sum(error >= FAILED for error in errors)
        worst = f"{failed} failed" if failed else _percent(max(errors, default=None))
        return f"{_percent(float(np.median(errors)) if errors else None)} ({worst})"

    def _nominal_table(self) -> str:
        case = self.cases[0].name
        heads = {
            "speed_load": "load speed %", "torque_shaft": "shaft torque %", "twist_elastic": "twist %",
            "f1_gap": "F1 of the gap", "impact_delay": "impact ms", "impacts_found": "impacts found",
            "backlash_error": "backlash %",
        }  # fmt: skip
        lines = [f"| {case} | " + " | ".join(heads.values()) + " |", "|---" * (len(heads) + 1) + "|"]
        for name in self.ranking():
            cells = []
            for metric in heads:
                found = self.median(name, case, metric)
                scale = 100.0 if metric in _PERCENT else 1e3 if metric == "impact_delay" else 1.0
                cells.append("–" if found is None else f"{scale * found.value:.3g}")
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
        return "\n".join(lines)


def _torque_sensor_alone(case: Case) -> bool:
    """Whether the case differs from the nominal one in the noise of the torque sensor alone."""
    nominal = Case(case.name, case.group, quick=case.quick)
    return case != nominal and replace(case, torque_noise=nominal.torque_noise) == nominal


def _micro(time: float | None) -> str:
    return "–" if time is None else f"{1e6 * time:.2f}"


def _percent(value: float | None) -> str:
    if value is None:
        return "–"
    if value >= FAILED:
        return "failed"
    return f"{100.0 * value:.2g}" if value < 0.995 else f"{100.0 * value:.0f}"

"""The leaderboard of the controllers: tables by kind of work and by group of cases."""

from __future__ import annotations

from typing import Any

from ...version import VERSION
from ..score_table import ScoreTable, plain
from ..statistics import Estimate, share
from .cases import Case
from .scores import METRICS

#: Heading and factor of a number in the tables.
COLUMNS = {
    "arrival_time": ("t90 ms", 1e3), "rise_time": ("rise ms", 1e3), "overshoot": ("overshoot %", 1.0),
    "settling_time": ("settle ms", 1e3), "steady_error": ("steady error %", 1e2), "peak_torque": ("peak Nm", 1.0),
    "rms_torque": ("RMS Nm", 1.0), "oscillation": ("oscillation rad/s", 1.0), "swing": ("swing rad/s", 1.0),
    "motor_overshoot": ("motor overshoot rad/s", 1.0), "motor_deviation": ("motor deviation rad/s", 1.0),
    "impacts": ("impacts", 1.0),
    "impact_speed": ("impact rad/s", 1.0), "lash_time": ("lash ms", 1e3), "load_jerk": ("jerk krad/s³", 1e-3),
    "recovery_error": ("largest error rad/s", 1.0), "recovery_time": ("back after ms", 1e3),
    "tracking_error": ("RMS error rad/s", 1.0), "ripple": ("torque ripple Nm", 1.0),
    "rest_speed": ("load speed rad/s", 1.0), "unstable": ("unstable %", 1e2), "refused": ("refused %", 1e2),
    "time_per_step": ("ns per step", 1e9),
}  # fmt: skip
#: What is shown of the cases of one kind of work.
SHOWN = {
    "step": ("arrival_time", "rise_time", "overshoot", "settling_time", "steady_error", "oscillation", "swing",
             "motor_overshoot", "motor_deviation", "peak_torque", "rms_torque", "impact_speed", "impacts", "lash_time",
             "load_jerk", "unstable", "refused", "time_per_step"),
    "pulse": ("arrival_time", "overshoot", "settling_time", "impact_speed", "motor_overshoot"),
    "load step": ("recovery_error", "recovery_time", "steady_error", "unstable"),
    "creep": ("tracking_error", "impact_speed", "impacts"),
    "rest": ("ripple", "rest_speed", "impacts", "unstable"),
    "tip-in": ("arrival_time", "overshoot", "load_jerk", "impact_speed", "lash_time", "unstable"),
    "tip-out": ("arrival_time", "overshoot", "load_jerk", "impact_speed", "lash_time", "unstable"),
}  # fmt: skip
#: Of these the share of the runs is given.
SHARES = ("unstable", "refused")
#: What is shown of each group of cases in which the drive or the model differs: its worst case.
BY_GROUP = ("overshoot", "impact_speed", "arrival_time", "unstable", "refused")


class ControlTable(ScoreTable[Case]):
    """Scores of all laws over all cases and seeds."""

    ENTRY = "controller"
    METRICS = METRICS

    def median(self, entry: str, case: str, metric: str) -> Estimate | None:
        """Median over seeds with its 95 % interval; of ``SHARES`` the share."""
        values = self.values(entry, case, metric)
        if metric in SHARES and values:
            return share(list(values.values()))
        return super().median(entry, case, metric)

    def worst(self, entry: str, case: str, metric: str) -> float | None:
        """The largest value over the seeds."""
        return max(self.values(entry, case, metric).values(), default=None)

    def worst_of_group(self, entry: str, group: str, metric: str) -> float | None:
        """The largest median of the group's cases; for ``SHARES`` that of all its runs."""
        cases = [case.name for case in self.cases if case.group == group]
        if metric in SHARES:
            runs = [v for case in cases for v in self.values(entry, case, metric).values()]
            return sum(runs) / len(runs) if runs else None
        medians = [found.value for case in cases if (found := self.median(entry, case, metric)) is not None]
        return max(medians, default=None)

    def to_dict(self) -> dict[str, Any]:
        """Everything, for JSON."""
        return {
            "schema": 1,
            "version": VERSION,
            "settings": dict(self.settings),
            "seeds": list(self.seeds),
            "controllers": [{"name": name, "kind": kind} for name, kind in self.entries.items()],
            "cases": [
                {
                    "name": case.name,
                    "group": case.group,
                    "work": case.work,
                    "controllers": {
                        name: {
                            metric: [*found, self.worst(name, case.name, metric)]
                            for metric in METRICS
                            if (found := plain(self.median(name, case.name, metric))) is not None
                        }
                        for name in self.entries
                    },
                }
                for case in self.cases
            ],
        }

    def to_markdown(self) -> str:
        """A table for each kind of work, then the worst case of each group."""
        remark = f"Medians of {len(self.seeds)} rigs, worst in brackets. t90: from the step to 90 %."
        singles = [case for case in self.cases if case.work != "step" or not _differs(case)]
        groups = tuple(dict.fromkeys(case.group for case in self.cases if case not in singles))
        tables = [self._case_table(case) for case in singles] + [
            self._group_table(m, groups) for m in BY_GROUP
        ]
        return "\n\n".join([remark, *filter(None, tables)]) + "\n"

    def _case_table(self, case: Case) -> str:
        columns = SHOWN[case.work]
        rows = [
            [name, *(self._cell(name, case.name, metric) for metric in columns)]
            for name in self.entries
            if any(self.values(name, case.name, metric) for metric in columns)
        ]
        return _table([case.name, *(COLUMNS[metric][0] for metric in columns)], rows)

    def _cell(self, entry: str, case: str, metric: str) -> str:
        found, worst, factor = (
            self.median(entry, case, metric),
            self.worst(entry, case, metric),
            COLUMNS[metric][1],
        )
        if found is None or worst is None:
            return "–"
        middle, largest = _number(factor * found.value), _number(factor * worst)
        alone = middle == largest or metric in ("time_per_step", *SHARES)
        return middle if alone else f"{middle} ({largest})"

    def _group_table(self, metric: str, groups: tuple[str, ...]) -> str:
        heading, factor = COLUMNS[metric]
        rows = []
        for name in self.entries:
            cells = [self.worst_of_group(name, group, metric) for group in groups]
            if any(cell is not None for cell in cells):
                rows.append([name, *("–" if cell is None else _number(factor * cell) for cell in cells)])
        return _table([f"{heading}, worst case", *groups], rows)


def _differs(case: Case) -> bool:
    """Whether rig or model differ from the nominal ones; each drive of the zoo is nominal."""
    same = Case(
        case.name,
        case.group,
        quick=case.quick,
        work=case.work,
        drive=case.drive,
        true_states=case.true_states,
    )
    return case != same


def _table(head: list[str], rows: list[list[str]]) -> str:
    """In Markdown; nothing without rows."""
    lines = [head, ["---"] * len(head), *rows] if rows else []
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _number(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 999.5 else f"{value:.0f}"

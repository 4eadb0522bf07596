"""What the command line shows while and after it works: a line for each stage, then the key numbers."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Column

from .display import parameters as parameter_table
from .display.wrapping import wrapped

#: Problems that are shown after a run; the report has them all (option).
SHOWN = 3
#: Widest bar, and what stands beside it, columns (option: a stage, its time and a few words).
BAR, BESIDE = 30, 46


def _bar(console: Console) -> BarColumn:
    """A bar that leaves a narrow terminal room for the words beside it."""
    return BarColumn(min(BAR, max(console.width - BESIDE, 4)))


def _whole() -> Column:
    """A column for a time or a stage, which is never shortened."""
    return Column(no_wrap=True, min_width=7)


class _Shown:
    """A progress display that runs within ``with``."""

    _progress: Progress

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()


class StageLines(_Shown):
    """A progress line for each stage on standard error; call it as ``run.Progress``.

    Without a terminal: a line where a stage starts and ends, and with ``every`` one for each such part of it.
    """

    def __init__(self, shown: bool = True, every: float = 1.0) -> None:
        self.shown = shown
        self._every = every
        self._reported: dict[str, int] = {}
        self._console = Console(stderr=True, highlight=False)
        self._progress = Progress(
            TextColumn("{task.fields[stage]:<9}", table_column=_whole()),
            _bar(self._console),
            TimeElapsedColumn(table_column=_whole()),
            TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis")),
            console=self._console,
            disable=not shown or not self._console.is_terminal,
        )
        self._tasks: dict[str, Any] = {}
        self._started: dict[str, float] = {}

    def __call__(self, stage: str, fraction: float, text: str = "") -> None:
        if stage not in self._tasks:
            self._tasks[stage] = self._progress.add_task("", total=1.0, stage=stage)
            self._started[stage] = time.perf_counter()
            if not self._console.is_terminal:
                self._console.print(f"{stage} …")
        done = fraction >= 1.0 and not text
        shown = text if not done else ""
        self._progress.update(self._tasks[stage], completed=fraction, description=shown)
        if self._console.is_terminal:
            return
        spent = time.perf_counter() - self._started[stage]
        if done:
            self._console.print(f"{stage} done in {spent:.1f} s")
        elif fraction < 1.0 and (parts := int(fraction / self._every + 1e-9)) > self._reported.get(stage, 0):
            self._reported[stage] = parts
            self._console.print(f"{stage} {100.0 * fraction:.0f} % in {spent:.0f} s")


class Countdown(_Shown):
    """A bar on standard error for work of known amount, with the time that is left; call it as (done, all, seconds)."""

    def __init__(self, what: str, shown: bool = True) -> None:
        console = Console(stderr=True, highlight=False)
        self._progress = Progress(
            TextColumn(what, table_column=Column(no_wrap=True, overflow="ellipsis")),
            _bar(console),
            MofNCompleteColumn(table_column=Column(no_wrap=True, min_width=3)),
            TimeElapsedColumn(table_column=_whole()),
            TextColumn("{task.description}", table_column=Column(no_wrap=True, overflow="ellipsis")),
            console=console,
            disable=not shown or not console.is_terminal,
        )
        self._task = self._progress.add_task("", total=None)
        if shown and not console.is_terminal:
            console.print(f"{what} …")

    def __call__(self, done: int, everything: int, remaining: float | None = None) -> None:
        left = f"{remaining:.0f} s left" if done < everything and remaining is not None else ""
        self._progress.update(self._task, completed=done, total=everything, description=left)


def summary(results: Mapping[str, Any], out: Path) -> None:
    """The key numbers and where the report is, on standard output."""
    parameters(results["parameters"])
    for part, signal in (("observer_1", "speed_load"), ("observer_1", "torque_shaft")):
        row = results["observers"].get(part, {}).get(signal, {})
        if row.get("range"):
            _print(f"  Observer 1, {signal}: RMSE {100.0 * row['rmse'] / row['range']:.2f} % of the range")
    for name in ("pi", "pole_placement"):
        row = results["controllers"].get(name, {})
        if "skipped" in row:
            _print(f"  {name}: {row['skipped']}")
        elif row.get("overshoot") is not None:
            _print(
                f"  {name}: overshoot {row['overshoot']:.1f} % of the step, peak torque {row['peak_torque']:.3g} Nm"
            )
    for name, fit in results["fits"].items():
        if "skipped" in fit:
            _print(f"  {name} skipped: {fit['skipped']}")
    for part in ("observers", "controllers", "export"):
        if "skipped" in results[part]:
            _print(f"  {part} skipped: {results[part]['skipped']}")
    problems = results["problems"]
    for problem in problems[:SHOWN]:
        _print("  {severity}: {where}: {got}. {remedy}".format(**problem))
    count = f"{len(problems)} warning{'' if len(problems) == 1 else 's'}"
    more = f" ({len(problems) - SHOWN} more in the report)" if len(problems) > SHOWN else ""
    _print(f"  {count}{more}; report: {out / 'report.html'}")


def parameters(table: Mapping[str, Any]) -> None:
    """One line for each parameter, on standard output."""
    _print(parameter_table.text(table))


def claims(content: Mapping[str, Any], out: Path) -> None:
    """What of the paper holds, and what does not, on standard output."""
    _print(f"  {content['headline']}")
    for claim in content["claims"]:
        if claim["verdict"] != "holds":
            _print(f"  {claim['verdict']}: {claim['name']}. {claim['sentence']}")
    _print(f"  page: {out / 'paper.html'}")


def _print(text: str) -> None:
    print(wrapped(text, sys.stdout))

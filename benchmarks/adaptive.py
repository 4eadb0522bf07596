"""Observers with one parameter off by 20 %: errors of load speed, shaft torque and elastic twist after 5 s.

    python benchmarks/adaptive.py --seeds 20

8 s of the leaderboard's experiment on rigs FIRST to FIRST + SEEDS − 1, judged from 5 s on; medians with their 95 %
bootstrap interval, in % of range. Prints Markdown tables: the worst case of every observer, then all cases of those
that estimate the stiffness, with the error of their parameters (of all observers with --all). The target is 1.5 % in
every case.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

from shared import parser_of

from lostmotion.compare import CASES, CONTESTANTS, Case
from lostmotion.compare.cases import PARAMETERS
from lostmotion.compare.experiment import experiment
from lostmotion.compare.scores import SIGNALS, score
from lostmotion.compare.statistics import median
from lostmotion.recording import Recording

DURATION, FROM, TARGET = 8.0, 5.0, 1.5
OFF = tuple(case for case in CASES if case.factors)
RIGHT = tuple(case for case in CASES if case.name in ("nominal", "identified"))
#: Observers that are shown; moving horizon on request.
NAMES = (
    "Observer 1", "load torque", "load torque, fast", "H∞, load torque", "extended Kalman", "unscented Kalman",
    "interacting models", "sliding mode", "super-twisting", "neural network",
)  # fmt: skip
#: Parameters that some observers estimate.
ESTIMATED = tuple(
    name for name in PARAMETERS if name in ("inertia_motor", "inertia_load", "stiffness", "backlash")
)

Row = dict[str, float]


class Kept:
    """An observer that stores its last estimates."""

    def __init__(self, observer) -> None:
        self.observer, self.inputs = observer, observer.inputs
        self.last: Recording | None = None

    def run(self, data: Recording) -> Recording:
        self.last = self.observer.run(data)
        return self.last


def one_rig(seed: int, names: tuple[str, ...]) -> dict[tuple[str, str], Row]:
    """(observer, case) → errors in %; of a parameter by its name, mean over the judged samples, with sign."""
    right = experiment(RIGHT[0], seed, 0.4).drivetrain.parameters()
    rows = {}
    for case in (*RIGHT, *OFF):
        data = experiment(case, seed, DURATION)
        data = replace(data, judged=slice(round(FROM / case.dt), len(data.recording)))
        for entry in CONTESTANTS:
            if entry.name in names:
                observer = Kept(entry.make(data.drivetrain, data.sensing))
                found = score(observer, data)
                row = {name: 100.0 * (found[name] or 0.0) for name in SIGNALS}
                assert observer.last is not None
                for name in ESTIMATED:
                    if f"{name}_estimated" in observer.last:
                        guess = observer.last[f"{name}_estimated"][data.judged].mean()
                        row[name] = 100.0 * (float(guess) / right[name] - 1.0)
                rows[entry.name, case.name] = row
    return rows


def cell(values: list[float], digits: int = 2) -> str:
    found = median(values)
    return f"{found.value:.{digits}f} ({found.low:.{digits}f} to {found.high:.{digits}f})"


def print_table(rigs: list[dict[tuple[str, str], Row]], name: str, cases: tuple[Case, ...]) -> None:
    """One observer: its cases, and the worst of those with a parameter off."""
    known = [p for p in ESTIMATED if p in rigs[0][name, cases[0].name]]
    print(f"\n### {name}\n")
    print(
        "| case | load speed % | shaft torque % | elastic twist % |"
        + "".join(f" {p}, error % |" for p in known)
    )
    print("|" + "---|" * (4 + len(known)))
    worst = dict.fromkeys(SIGNALS, 0.0)
    for case in cases:
        rows = [rig[name, case.name] for rig in rigs]
        cells = [cell([row[s] for row in rows]) for s in SIGNALS] + [
            cell([row[p] for row in rows], 1) for p in known
        ]
        print(f"| {case.name} | " + " | ".join(cells) + " |")
        if case.factors:
            worst = {s: max(worst[s], median([row[s] for row in rows]).value) for s in SIGNALS}
    verdict = "met" if max(worst.values()) <= TARGET else "missed"
    print(
        f"| worst of {len(OFF)}, target {TARGET:g}: {verdict} | "
        + " | ".join(f"{v:.2f}" for v in worst.values())
        + " |"
    )


def print_summary(rigs: list[dict[tuple[str, str], Row]], names: list[str]) -> None:
    """All observers: nominal, then the worst median of the cases with a parameter off, and where."""
    print(f"\n| observer: nominal; worst of {len(OFF)} | load speed % | shaft torque % | elastic twist % |")
    print("|---|---|---|---|")
    for name in names:
        cells = []
        for signal in SIGNALS:
            medians = {c.name: median([rig[name, c.name][signal] for rig in rigs]).value for c in OFF}
            where = max(medians, key=medians.__getitem__)
            nominal = median([rig[name, RIGHT[0].name][signal] for rig in rigs]).value
            cells.append(f"{nominal:.2f}; {medians[where]:.2f} ({where})")
        print(f"| {name} | " + " | ".join(cells) + " |")


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="how many rigs")
    parser.add_argument("--first", type=int, default=1, help="the first of them")
    parser.add_argument("--slow", action="store_true", help="the moving horizon too")
    parser.add_argument("--all", action="store_true", help="all cases of every observer")
    arguments = parser.parse_args()
    names = (*NAMES, "moving horizon") if arguments.slow else NAMES
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        rigs = list(pool.map(one_rig, seeds, [names] * len(seeds)))
    shown = [entry.name for entry in CONTESTANTS if entry.name in names]
    print_summary(rigs, shown)
    for name in shown:
        if arguments.all or "stiffness" in rigs[0][name, RIGHT[0].name]:
            print_table(rigs, name, (*RIGHT, *OFF))


if __name__ == "__main__":
    main()

"""Chains of 3 to 20 masses against an independent integration, for every contact law, over many random windows.

    python benchmarks/accuracy.py --windows 60

Each window is a random chain with backlash in three shafts (two of three masses), friction at three inertias, noise of
20 Nm and a constant torque of 15 Nm, 60 samples at 10 kHz, from a random start in, at the edge of and beyond the gaps.
Reference: scipy's DOP853 from event to event (tests/simulation/independent.py) at rtol 1e-13. A window is left out
where that reference at rtol 1e-12 differs by more than 1e-10 of the range. Prints a Markdown table.

scipy looks for events at the ends of its steps and misses two crossings within one step, at both tolerances alike.
So windows that differ by more than 1e-9 are judged again with steps of at most 2 µs, and both results are printed.
"""

from __future__ import annotations

import os
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from rich.progress import track
from shared import parser_of

from lostmotion.drivetrain import CONTACT_LAWS

sys.path.insert(0, str(Path(__file__).parent.parent / "tests" / "simulation"))
from windows import Judged, judge

MASSES = (3, 4, 6, 12, 20)
SAMPLES = 60
BOUND = 1e-9
#: Largest step of the second run of windows beyond the bound, s.
SHORT_STEP = 2e-6


def judged(job: tuple[int, str, int]) -> Judged:
    return judge(*job, SAMPLES)


def row(name: str, windows: list[Judged]) -> str:
    kept = np.array([w.error for w in windows if w.counts])
    out = len(windows) - kept.size
    events = sum(w.events for w in windows if w.counts)
    return (
        f"| {name} | {len(windows)} | {events} | {out} ({100 * out / len(windows):.2g} %) | {np.median(kept):.1e} | "
        f"{np.quantile(kept, 0.99):.1e} | {kept.max():.1e} | {np.count_nonzero(kept > BOUND)} |"
    )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--windows", type=int, default=60, help="windows of each number of masses and law")
    parser.add_argument("--seed", type=int, default=0, help="seed of the first window")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    arguments = parser.parse_args()
    seeds = range(arguments.seed, arguments.seed + arguments.windows)
    jobs = [(n, contact, seed) for n in MASSES for contact in CONTACT_LAWS for seed in seeds]
    with ProcessPoolExecutor(arguments.workers) as pool:
        found = dict(zip(jobs, track(pool.map(judged, jobs, chunksize=4), total=len(jobs)), strict=True))
    print(
        "| masses, contact law | windows | events | left out | median error | 99 % | largest | beyond 1e-9 |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for contact in CONTACT_LAWS:
        print(row(contact, [w for (_, law, _), w in found.items() if law == contact]))
    for n in MASSES:
        print(row(f"{n} masses", [w for (masses, _, _), w in found.items() if masses == n]))
    print(row("all", list(found.values())))
    for job, window in found.items():
        if window.counts and window.error > BOUND:
            closer = judge(*job, SAMPLES, SHORT_STEP)
            print(f"beyond: {job}, error {window.error:.1e}, {window.events} events in the reference;")
            print(f"  with steps of at most 2 µs error {closer.error:.1e}, {closer.events} events")


if __name__ == "__main__":
    main()

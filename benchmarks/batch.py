"""Time, memory and threads of a batch: variants of the paper's drivetrain, summaries only.

    python benchmarks/batch.py --variants 10000

Variants differ by up to 20 % in every number; 1 s at 10 kHz under noise and a square wave (seed 0), about 220 events
per second. Each line is a process of its own: peaks, RMS, final states and event counts of four signals, 200 times of
the load speed for its quantiles. Times: process time; with several threads, also wall time against that of one thread
in the same run.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
import time

import numpy as np
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion.simulation import simulate_batch

DT, SAMPLES = 1e-4, 10_000


def variants(count: int) -> list[lm.Drivetrain]:
    rng = np.random.default_rng(1)
    factors = rng.uniform(0.8, 1.2, (count, len(TABLE_I)))
    return [
        lm.Drivetrain.two_mass(
            **dict(zip(TABLE_I, row * list(TABLE_I.values()), strict=True)), contact="dead_zone"
        )
        for row in factors
    ]


def torque() -> np.ndarray:
    """Noise of 10 Nm RMS and a square wave of 9 Nm at 20 Hz."""
    square = np.sign(np.sin(2.0 * np.pi * 20.0 * np.arange(SAMPLES) * DT))
    return 10.0 * np.random.default_rng(0).standard_normal(SAMPLES) + 9.0 * square


def run(count: int, workers: int) -> dict[str, float]:
    """One batch in this process; a small one before it loads what is compiled."""
    arguments = dict(dt=DT, torque_motor=torque(), quantiles=("speed_load",), workers=workers)
    plants = variants(count)
    simulate_batch(plants[:2], **arguments)
    wall, spent = time.perf_counter(), time.process_time()
    made = simulate_batch(plants, **arguments)
    wall, spent = time.perf_counter() - wall, time.process_time() - spent
    assert made.done.all()
    return {
        "wall": wall,
        "process": spent,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "events": float(sum(np.sum(made.events[kind]) for kind in made.events)) / count,
        "sum": float(np.sum(made.final_state) + np.sum(made.rms["torque_shaft"])),
    }


def apart(count: int, workers: int) -> dict[str, float]:
    command = [sys.executable, __file__, "--variants", str(count), "--here", str(workers)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--variants", type=int, default=10_000)
    parser.add_argument("--runs", type=int, default=3, help="The fastest of so many.")
    parser.add_argument("--here", type=int, default=0, help="Run in this process with so many threads.")
    arguments = parser.parse_args()
    if arguments.here:
        print(json.dumps(run(arguments.variants, arguments.here)))
        return
    samples = arguments.variants * SAMPLES
    print(
        "| threads | wall time, s | process time per sample, ns | times one thread | peak memory, MB | events per s |"
    )
    print("|---|---|---|---|---|---|")
    first: dict[str, float] = {}
    for workers in (1, 2):
        made = [apart(arguments.variants, workers) for _ in range(arguments.runs)]
        best = {name: min(row[name] for row in made) for name in made[0]}
        first = first or best
        assert best["sum"] == first["sum"]  # the same numbers, whatever the threads
        print(
            f"| {workers} | {best['wall']:.2f} | {best['process'] / samples * 1e9:.1f} "
            f"| {first['wall'] / best['wall']:.2f} | {max(row['memory'] for row in made):.0f} | {best['events']:.0f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()

"""Design of a test for drives of the zoo: predicted half widths of the intervals against those found, and errors.

    python benchmarks/zoo_excitation.py --first 3300 --drives 20 --results excitation.jsonl

Each drive is in the virtual rig's units (``rig.bench``). The test is designed from a nameplate whose values are off by
up to FACTOR either way, then played on the drive. Prints a Markdown table; goes on where the results file ends.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from shared import parser_of, read

import lostmotion as lm
from lostmotion.errors import LostMotionError
from lostmotion.experiment import design_excitation

NAMES = ("inertia_motor", "inertia_load", "stiffness", "backlash")
#: rad/s, in the virtual rig's units; rows at most (option: those of docs/benchmarks/excitation.md; half a minute).
SPEED, ROWS = 45.0, 30_000


def played(seed: int, factor: float) -> dict[str, Any] | None:
    """Predicted and found half widths (relative) of a drive, and its errors; None if it is no drive with one gap."""
    bench = lm.rig.bench(seed)
    if bench is None:
        return None
    rng = np.random.default_rng(seed)
    off = {name: factor ** rng.uniform(-1.0, 1.0) for name in (*NAMES, "coulomb")}
    values = {name: by * getattr(bench.model, name) for name, by in off.items()}
    limit = bench.rig.drivetrain.actuator.torque_limit
    bits = round(math.log2(2.0 * math.pi / bench.rig.sensors["speed_motor"].resolution))
    entry: dict[str, Any] = {"seed": seed, "masses": len(bench.rig.drivetrain.inertias), "bits": bits}
    duration = min(10.0, ROWS * bench.dt)
    try:
        nameplate = bench.model.with_parameters(**values)
        design = design_excitation(
            nameplate,
            torque_limit=limit,
            speed_limit=SPEED,
            dt=bench.dt,
            duration=duration,
            encoder_bits=bits,
        )
        recording, truth = lm.rig.record(
            bench.rig,
            torque_motor=design.recording["torque_motor"],
            dt=bench.dt,
            delay=bench.delay,
            channels=("speed_motor",),
        )
        found = lm.identify(recording.only("torque_motor", "speed_motor"), start=nameplate)
    except LostMotionError as refusal:
        return entry | {"refusal": str(refusal)[:200]}
    true = lm.rig.two_mass_equivalent(bench.rig.drivetrain, truth.signals["speed_load"])
    entry["predicted"] = {name: half for name, half in design.half_widths.items() if name in NAMES}
    entry["found"] = {
        name: {
            "half": (high - low) / 2.0 / found.values[name],
            "error": found.values[name] / true[name] - 1.0,
            "holds": low <= true[name] <= high,
        }
        for name, (low, high) in found.intervals.items()
        if name in NAMES and found.sources[name] == "identified" and true[name]
    }
    return entry


def run(seeds: Iterable[int], factor: float, results: Path, processes: int) -> None:
    done = {entry["seed"] for entry in read(results)}
    todo = [seed for seed in seeds if seed not in done]
    with results.open("a") as file, ProcessPoolExecutor(processes) as pool:
        for entry in pool.map(partial(played, factor=factor), todo):
            if entry is not None:
                file.write(json.dumps(entry) + "\n")
                file.flush()
                print(f"seed {entry['seed']}: {entry.get('refusal', 'played')}", flush=True)


def table(entries: list[dict[str, Any]]) -> str:
    """For each parameter: how often it is predicted and found, the ratio of half widths, errors, coverage."""
    lines = [
        "| parameter | predicted | of these found | found alone | found over predicted: median, 10 %, 90 % "
        "| error, median, % | holds |",
        "|---" * 7 + "|",
    ]
    for name in NAMES:
        both = [
            (e["predicted"][name], e["found"][name])
            for e in entries
            if name in e["predicted"] and name in e["found"]
        ]
        predicted = sum(name in e["predicted"] for e in entries)
        found = [e["found"][name] for e in entries if name in e["found"]]
        ratios = [one["half"] / half for half, one in both] or [math.nan]
        errors = [100.0 * abs(one["error"]) for one in found] or [math.nan]
        low, middle, high = np.quantile(ratios, [0.1, 0.5, 0.9])
        lines.append(
            f"| {name} | {predicted} of {len(entries)} | {len(both)} | {len(found) - len(both)} "
            f"| {middle:.2f}, {low:.2f}, {high:.2f} | {np.median(errors):.2g} "
            f"| {sum(one['holds'] for one in found)} of {len(found)} |"
        )
    return "\n".join(lines)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--first", type=int, default=0, help="seed of the first drive")
    parser.add_argument(
        "--drives", type=int, default=20, help="so many seeds; those without one gap are left out"
    )
    parser.add_argument(
        "--factor", type=float, default=1.5, help="the nameplate is off by up to this, either way"
    )
    parser.add_argument("--results", type=Path, required=True, help="a line of JSON for each drive")
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.first + arguments.drives)
    run(seeds, arguments.factor, arguments.results, arguments.processes)
    lines = read(arguments.results)
    entries = [entry for entry in lines if "refusal" not in entry]
    print(f"{len(entries)} drives; refused: {len(lines) - len(entries)}")
    print(table(entries))


if __name__ == "__main__":
    np.seterr(all="ignore")
    main()

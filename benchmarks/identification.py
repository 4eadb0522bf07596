"""Identification on the virtual rig: error of every parameter against the equivalent two-mass drivetrain.

    python benchmarks/identification.py --seeds 20

Prints a Markdown table: error in %, ✗ where the 95 % interval misses the truth, – where nothing was
identified. The start values are off by exactly a factor of two, up or down at random.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import lostmotion as lm
from lostmotion.identification import Identification
from lostmotion.identification.predictor import NAMES


def start_off_by(truth: dict[str, float], factor: float, seed: int) -> lm.Drivetrain:
    """The truth with every parameter multiplied or divided by ``factor``."""
    signs = np.random.default_rng([seed, 77]).choice([-1.0, 1.0], len(NAMES))
    return lm.Drivetrain.two_mass(
        **{name: truth[name] * factor**sign for name, sign in zip(NAMES, signs, strict=True)}
    )


def cell(found: Identification, truth: dict[str, float], name: str) -> tuple[str, float, bool | None]:
    """Text, error in %, and whether the interval holds the truth."""
    value = found.values[name]
    if value is None or name not in found.intervals:
        return "–", np.nan, None
    low, high = found.intervals[name]
    error, hit = 100.0 * (value / truth[name] - 1.0), low <= truth[name] <= high
    half = 50.0 * (high - low) / truth[name]
    return f"{error:+.2f} ± {half:.1f}{'' if hit else ' ✗'}", error, hit


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=20, help="rigs 1 to SEEDS")
    parser.add_argument("--factor", type=float, default=2.0, help="how far the start values are off")
    arguments = parser.parse_args()
    print("| rig | " + " | ".join(NAMES) + " | time s |")
    print("|---" * (len(NAMES) + 2) + "|")
    errors, hits, times = [], [], []
    for seed in range(1, arguments.seeds + 1):
        recording, truth = lm.rig.record(seed)
        start = start_off_by(truth.parameters, arguments.factor, seed)
        before = time.perf_counter()
        found = lm.identify(recording, start=start)
        times.append(time.perf_counter() - before)
        cells = [cell(found, truth.parameters, name) for name in NAMES]
        errors.append([c[1] for c in cells])
        hits.append([c[2] for c in cells])
        print(f"| {seed} | " + " | ".join(c[0] for c in cells) + f" | {times[-1]:.2f} |", flush=True)
    worst = np.nanmax(np.abs(errors), axis=0)
    print(
        "| **largest error** | "
        + " | ".join(f"{w:.2f}" for w in worst)
        + f" | median {np.median(times):.2f} |"
    )
    counts = [
        f"{sum(bool(h) for h in column)} of {sum(h is not None for h in column)}"
        for column in zip(*hits, strict=True)
    ]
    print("| **in interval** | " + " | ".join(counts) + " | |")


if __name__ == "__main__":
    main()

"""Identification: errors on the virtual rig, and coverage of the intervals without model error.

    python benchmarks/identification.py --seeds 20             # the rig in open loop
    python benchmarks/identification.py --seeds 20 --closed    # the rig under PI control with dither
    python benchmarks/identification.py --coverage 100         # two masses, exactly simulated, 20 bit counts

The first two print a Markdown table: error in %, ✗ where the 95 % interval misses the truth, – where nothing was
identified. The start values are off by exactly a factor of two, up or down at random.
"""

from __future__ import annotations

import time

import numpy as np
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion.identification import Identification
from lostmotion.identification.prediction_error.innovations import NAMES

DT = 1e-4
#: Table I and a torque lag.
LAGGED = {**TABLE_I, "lag": 3e-4}


def start_off_by(truth: dict[str, float], factor: float, seed: int) -> lm.Drivetrain:
    """The truth with every parameter multiplied or divided by ``factor``."""
    signs = np.random.default_rng([seed, 77]).choice([-1.0, 1.0], len(NAMES))
    return lm.Drivetrain.two_mass(
        **{name: truth[name] * factor**sign for name, sign in zip(NAMES, signs, strict=True)}
    )


def cell(found: Identification, truth: dict[str, float], name: str) -> tuple[str, float, bool | None]:
    """Text, error in %, and whether the interval contains the truth."""
    value = found.values[name]
    if value is None or name not in found.intervals:
        return "–", np.nan, None
    low, high = found.intervals[name]
    error, hit = 100.0 * (value / truth[name] - 1.0), low <= truth[name] <= high
    half = 50.0 * (high - low) / truth[name]
    return f"{error:+.2f} ± {half:.1f}{'' if hit else ' ✗'}", error, hit


def closed_loop(seed: int) -> tuple[lm.Recording, lm.rig.Truth]:
    """Ramps between speed levels under PI control, with noise on the set-point."""
    levels = np.repeat([10.0, 25.0, -10.0, -25.0, 15.0, -15.0], 16667)[:100000]
    ramps = np.convolve(np.r_[np.zeros(5000), levels], np.ones(5000) / 5000.0, "valid")[:100000]
    dither = lm.signals.noise(2.0, 120.0, 0.8, 10.0, DT, seed=seed)
    law = lm.controllers.pi(kp=10.0, ki=200.0, dt=DT, torque_limit=lm.rig.TORQUE_LIMIT)
    return lm.rig.record(seed, law=law, speed_reference=ramps + dither)


def on_the_rig(seeds: int, factor: float, closed: bool) -> None:
    print("| rig | " + " | ".join(NAMES) + " | time s |")
    print("|---" * (len(NAMES) + 2) + "|")
    errors, hits, times = [], [], []
    for seed in range(1, seeds + 1):
        recording, truth = closed_loop(seed) if closed else lm.rig.record(seed)
        start = start_off_by(truth.parameters, factor, seed)
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
    print("| **interval contains the truth** | " + " | ".join(counts) + " | |")


def exact_recording(seed: int) -> lm.Recording:
    """Two masses, excitation of the seed, torque and speed from 20 bit counts: no model error."""
    torque = lm.signals.excitation(10.0, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(lm.Drivetrain.two_mass(**LAGGED), torque_motor=torque, dt=DT)
    count = 2.0 * np.pi / 2**20
    counts = np.floor(run["angle_motor"] / count + np.random.default_rng([seed, 5]).uniform())
    speed = np.diff(counts, prepend=counts[0]) * count / DT
    return run.only("torque_motor").with_signals("simulated", speed_motor=speed)


def coverage(seeds: int) -> None:
    """Share of the 95 % intervals that contain the truth, in %, and their median half widths."""
    hits, statistical, half = [], [], []
    start = lm.Drivetrain.two_mass(**LAGGED)
    for seed in range(1, seeds + 1):
        found = lm.identify(exact_recording(seed), start=start)
        low, high = np.array([found.intervals[n] for n in NAMES]).T
        truth = np.array([LAGGED[n] for n in NAMES])
        hits.append((low <= truth) & (truth <= high))
        half.append(50.0 * (high - low) / truth)
        value = np.array([found.values[n] for n in NAMES])
        # The covariance is that of the logarithms, of lag + sample time for the lag.
        shift = np.log(value + DT * (truth == LAGGED["lag"])) - np.log(truth + DT * (truth == LAGGED["lag"]))
        statistical.append(np.abs(shift) <= 2.18 * np.sqrt(np.diag(found.covariance)))
    print("| | " + " | ".join(NAMES) + " | pooled |")
    print("|---" * (len(NAMES) + 2) + "|")
    for title, table in (("coverage, %", hits), ("coverage of the statistical part, %", statistical)):
        share = 100.0 * np.mean(table, axis=0)
        print(f"| {title} | " + " | ".join(f"{s:.0f}" for s in share) + f" | {np.mean(share):.1f} |")
    print("| median half width, % | " + " | ".join(f"{h:.2f}" for h in np.median(half, axis=0)) + " | |")


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="rigs 1 to SEEDS")
    parser.add_argument("--factor", type=float, default=2.0, help="how far the start values are off")
    parser.add_argument("--closed", action="store_true", help="under PI control with dither")
    parser.add_argument(
        "--coverage", type=int, default=0, metavar="N", help="exact recordings 1 to N instead"
    )
    arguments = parser.parse_args()
    if arguments.coverage:
        coverage(arguments.coverage)
    else:
        on_the_rig(arguments.seeds, arguments.factor, arguments.closed)


if __name__ == "__main__":
    main()

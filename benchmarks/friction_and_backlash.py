"""Coverage and errors of friction, locked-load backlash and lost motion.

    python benchmarks/friction_and_backlash.py --seeds 40

Prints a Markdown table: per case the median and the largest error, the median half width of the interval, and the
coverage: the share of the seeds whose 95 % interval contains the truth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline
from shared import parser_of

import lostmotion as lm
from lostmotion.identification import (
    breakaway,
    friction_ladder,
    locked_backlash,
    lost_motion,
    torque_step,
)
from lostmotion.rig import varied_rig

DT = 1e-3
#: name → (value, (low, high), truth)
Outcome = dict[str, tuple[float, tuple[float, float], float]]


def counts(angle: np.ndarray, bits: int, random: np.random.Generator) -> np.ndarray:
    count = 2.0 * np.pi / 2**bits
    return np.asarray(np.floor(angle / count + random.uniform()) * count)


def step(seed: int, known: bool) -> Outcome:
    """Rig `seed`, 12 Nm for 6 s and coasting for 4 s; torque measured with 0.3 Nm of noise, a ripple in it."""
    random = np.random.default_rng([seed, 1])
    torque = np.concatenate([np.full(6000, 12.0), np.zeros(4000)]) + 0.3 * random.standard_normal(10000)
    recording, truth = lm.rig.record(seed, torque_motor=torque, dt=DT, noise_seed=seed)
    noisy = recording["torque_motor"] + 0.3 * random.standard_normal(10000)
    inertia = truth.parameters["inertia_motor"] + truth.parameters["inertia_load"]
    recording = recording.with_signals("simulated", torque_motor=noisy)
    found = torque_step(recording, inertia=inertia if known else None)
    # Above 2 rad/s the rig's Stribeck rise is over: the step identifies its levels without it.
    disc = truth.drivetrain.frictions[-1]
    truths = {"inertia": inertia, "coulomb": disc.coulomb_plus, "viscous": disc.viscous}
    return {n: (float(found.values[n] or np.nan), i, truths[n]) for n, i in found.intervals.items()}


def ramps(seed: int) -> Outcome:
    """Rig `seed`, three ramps of 1 Nm/s in each direction, 16 bit at the motor."""
    ramp = np.concatenate([np.linspace(0.0, 4.0, 4000), np.zeros(3000)])
    random = np.random.default_rng([seed, 2])
    torque = np.concatenate([ramp, -ramp] * 3) + 0.02 * random.standard_normal(42000)
    _, truth = lm.rig.record(seed, torque_motor=torque, dt=DT)
    angle = counts(truth.signals["angle_motor"], 16, random)
    recording = lm.Recording(truth.signals.time, {"torque_motor": torque, "angle_motor": angle})
    found = breakaway(recording)
    level = max(truth.drivetrain.frictions[-1].level_at_rest)
    return {n: (float(found.values[n] or np.nan), i, level) for n, i in found.intervals.items()}


def constant_speeds(seed: int) -> Outcome:
    """Rig `seed` under PI control, ten speeds in each direction for 2 s each."""
    speeds = [0.3, 0.5, 0.8, 1.2, 2.0, 3.0, 5.0, 10.0, 20.0, 40.0]
    reference = np.repeat([s * w for s in (1.0, -1.0) for w in speeds], 2000)
    law = lm.controllers.pi(dt=DT, kp=1.0, ki=5.0)
    recording, truth = lm.rig.record(seed, law=law, speed_reference=reference, dt=DT, noise_seed=seed)
    found = friction_ladder(
        recording, inertia=truth.parameters["inertia_motor"] + truth.parameters["inertia_load"]
    )
    disc = truth.drivetrain.frictions[-1]
    truths = {"coulomb": disc.coulomb_plus, "viscous": disc.viscous, "stribeck": disc.stribeck[0][1]}
    return {n: (float(found.values[n] or np.nan), found.intervals[n], t) for n, t in truths.items()}


def locked(seed: int, bits: int) -> Outcome:
    """Rig `seed` with its brakes closed and 0 to 0.6 Nm of friction at the motor, three triangles of ±15 Nm."""
    random = np.random.default_rng([seed, 3])
    chain = varied_rig(seed).drivetrain
    frictions = (lm.Friction(float(random.uniform(0.0, 0.6))), *chain.frictions[1:-1], lm.Friction(1000.0))
    t = np.arange(12000) * DT
    torque = 15.0 * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * t / 4.0))
    run = lm.simulate(replace(chain, frictions=frictions), dt=DT, torque_motor=torque)
    angle = counts(run["angle_motor"], bits, random)
    found = locked_backlash(lm.Recording(t, {"torque_motor": run["torque_motor"], "angle_motor": angle}))
    stiffness = 1.0 / sum(1.0 / shaft.stiffness for shaft in chain.shafts)
    truths = {"backlash": chain.shafts[-1].backlash, "stiffness": stiffness}
    outcome: Outcome = {}
    for name, truth in truths.items():
        value = found.values[name]
        if value is not None and name in found.intervals:
            outcome[name] = (value, found.intervals[name], truth)
    return outcome


def between(seed: int, backlash: float) -> Outcome:
    """Two masses, encoders of 16 bit, the load's late by 1 to 5 ms; torque of the motor, its inertia known."""
    random = np.random.default_rng([seed, 4])
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.9, damping=0.397, backlash=backlash,
        coulomb=2.0, viscous=0.0175, coulomb_motor=0.3, contact="physical",
    )  # fmt: skip
    t, delay = np.arange(15000) * DT, float(random.uniform(1e-3, 5e-3))
    phase = random.uniform(0.0, 2.0 * np.pi, 2)
    torque = 8.0 * np.sin(4.4 * t + phase[0]) + 4.0 * np.sin(1.63 * t + phase[1])
    run = lm.simulate(plant, dt=DT, torque_motor=torque)
    late = CubicSpline(t, run["angle_load"])(t - delay)
    signals = {"angle_motor": counts(run["angle_motor"], 16, random), "angle_load": counts(late, 16, random)}
    recording = lm.Recording(t, {"torque_motor": run["torque_motor"], **signals})
    found = lost_motion(recording, inertia_motor=0.0182)
    outcome = {"delay": (float(found.values["delay"] or np.nan), found.intervals["delay"], delay)}
    if found.values["backlash"] is not None:
        outcome["backlash"] = (found.values["backlash"], found.intervals["backlash"], backlash)
    return outcome


CASES: dict[str, Callable[[int], Outcome]] = {
    "torque step, inertia known": lambda s: step(s, True),
    "torque step, inertia unknown": lambda s: step(s, False),
    "ramps": ramps,
    "constant speeds": constant_speeds,
    "locked load, 16 bit": lambda s: locked(s, 16),
    "locked load, 14 bit": lambda s: locked(s, 14),
    "locked load, 12 bit": lambda s: locked(s, 12),
    "lost motion, gap 12 mrad": lambda s: between(s, 0.012),
    "lost motion, gap 3 mrad": lambda s: between(s, 0.003),
    "lost motion, no gap": lambda s: between(s, 0.0),
}


def rows(case: str, outcomes: list[Outcome]) -> None:
    names = dict.fromkeys(n for o in outcomes for n in o)
    for name in names:
        value, low, high, truth = np.array(
            [(o[name][0], *o[name][1], o[name][2]) for o in outcomes if name in o]
        ).T
        scale = np.where(truth == 0.0, 1.0, truth) / 100.0
        error, half = np.abs(value - truth) / scale, 0.5 * (high - low) / scale
        coverage = np.mean((low <= truth) & (truth <= high))
        print(
            f"| {case} | {name} | {value.size} of {len(outcomes)} | {np.median(error):.2g} | {error.max():.2g} "
            f"| {np.median(half):.2g} | {100.0 * coverage:.0f} |",
            flush=True,
        )


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--only", default="", help="cases whose name contains this text")
    arguments = parser.parse_args()
    print(
        "| case | value | identified in | error, median % | largest % | half interval, median % | coverage, % |"
    )
    print("|---|---|---|---|---|---|---|")
    for case, run in CASES.items():
        if arguments.only in case:
            rows(case, [run(seed) for seed in range(1, arguments.seeds + 1)])


if __name__ == "__main__":
    main()

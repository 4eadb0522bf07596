"""What the calibrated constants do: the error of a result with half, all and double of each, on stated recordings.

    python benchmarks/calibrations.py [NAME …]

Recordings: the virtual rigs 1 to 4 and two masses of Table I, seeds 1 to 4. Shown: median / largest error. A row whose
numbers hardly differ says that the constant may be anything near; comments at the constants quote this table.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.identification import breakaway, friction_ladder, locked_backlash, lost_motion, torque_step
from lostmotion.recording import Recording

DT = 1e-3
SEEDS = (1, 2, 3, 4)
TABLE_I = dict(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175,
)  # fmt: skip
CURVE = lm.Friction(2.0, 0.0175, stribeck=((0.0, 0.3), (0.4, 0.154), (0.8, 0.079), (1.6, 0.021), (3.0, 0.0)))


def counted(angle: np.ndarray, bits: int, rng: np.random.Generator, noise: float = 0.0) -> np.ndarray:
    """An angle in counts, at any phase of a count, with noise of so many counts."""
    count = 2.0 * np.pi / 2**bits
    noisy = angle / count + rng.uniform() + noise * rng.standard_normal(angle.size)
    return np.asarray(np.floor(noisy) * count)


@cache
def locked_loads() -> list[tuple[Recording, float]]:
    """Rigs with their brakes closed: ramps, sine and plateaus of the torque, 12 and 16 bit; and the true gaps."""
    made = []
    t = np.arange(12_000) * DT
    ramp = 15.0 * 2.0 / np.pi * np.arcsin(np.sin(0.5 * np.pi * t))
    level = 15.0 * np.array([0.3, 0.6, 1.0, 0.6, 0.3, -0.3, -0.6, -1.0, -0.6, -0.3] * 3)
    plateaus = np.interp(t, np.arange(60) * 0.2, np.repeat(level, 2))
    for seed in SEEDS:
        truth = lm.rig.record(seed, torque_motor=np.zeros(3), dt=DT)[1].drivetrain
        chain = replace(truth, frictions=(lm.Friction(0.3), *truth.frictions[1:-1], lm.Friction(1000.0)))
        for number, torque in enumerate((ramp, 15.0 * np.sin(0.5 * np.pi * t), plateaus)):
            rng = np.random.default_rng((seed, number))
            run = lm.simulate(chain, dt=DT, torque_motor=torque)
            for bits in (12, 16):
                angle = counted(run["angle_motor"], bits, rng, noise=0.5)
                signals = {
                    "torque_motor": run["torque_motor"] + 0.05 * rng.standard_normal(t.size),
                    "angle_motor": angle,
                }
                made.append((Recording(t, signals), max(s.backlash for s in chain.shafts)))
    return made


def locked_backlash_error() -> str:
    errors = []
    for recording, gap in locked_loads():
        value = locked_backlash(recording).values["backlash"]
        errors.append(np.inf if value is None else abs(value / gap - 1.0))
    return spread(errors)


@cache
def two_encoders() -> list[Recording]:
    made = []
    t = np.arange(15_000) * DT
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        a, b = rng.uniform(0.0, 2.0 * np.pi, 2)
        torque = 8.0 * np.sin(2.0 * np.pi * 0.7 * t + a) + 4.0 * np.sin(2.0 * np.pi * 0.26 * t + b)
        plant = lm.Drivetrain.two_mass(
            **{**TABLE_I, "backlash": 0.003}, coulomb_motor=0.3, contact="physical"
        )
        run = lm.simulate(plant, dt=DT, torque_motor=torque)
        signals = {
            "torque_shaft": run["torque_shaft"] + 0.1 * rng.standard_normal(t.size),
            "angle_motor": counted(run["angle_motor"], 16, rng),
            "angle_load": counted(np.interp(t - 3.2e-3, t, run["angle_load"]), 16, rng),
        }
        made.append(Recording(t, signals))
    return made


def lost_motion_error() -> str:
    found = [lost_motion(recording).values["backlash"] for recording in two_encoders()]
    return spread([np.inf if value is None else abs(value / 0.003 - 1.0) for value in found])


@cache
def starts() -> list[tuple[Recording, float]]:
    """Slow ramps of the torque on the rigs, which break away; and their true levels."""
    made = []
    ramp = np.concatenate([np.linspace(0.0, 4.0, 4000), np.zeros(3000)])
    for seed in SEEDS:
        recording, truth = lm.rig.record(seed, torque_motor=np.concatenate([ramp, -ramp] * 2), dt=DT)
        angle = DT * np.cumsum(recording["speed_motor"])
        level = max(truth.drivetrain.frictions[-1].level_at_rest)
        made.append((recording.with_signals("derived", angle_motor=angle), level))
    return made


def breakaway_error() -> str:
    errors = []
    for recording, level in starts():
        value = breakaway(recording).values["breakaway_plus"]
        errors.append(np.inf if value is None else abs(value / level - 1.0))
    return spread(errors)


def ladder_error() -> str:
    """Plateaus of a controlled speed, of which the slowest slip and stick: 0.1 ± 0.3 rad/s."""
    errors = []
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        speeds = np.repeat(
            [s * w for s in (1, -1) for w in (0.1, 0.3, 0.5, 0.8, 1.2, 2.0, 4.0, 8.0, 16.0, 32.0)], 1000
        )
        slips = np.abs(speeds) < 0.2
        speed = (
            speeds
            + 0.01 * rng.standard_normal(speeds.size)
            + slips * 0.3 * np.sin(np.arange(speeds.size) / 8.0)
        )
        torque = (
            np.array([CURVE.torque(w) for w in speeds])
            + 0.05 * rng.standard_normal(speeds.size)
            + 0.3 * slips
        )
        signals = {"speed_reference": speeds, "speed_motor": speed, "torque_motor": torque}
        value = friction_ladder(Recording(DT * np.arange(speeds.size), signals)).values["stribeck"]
        errors.append(np.inf if value is None else abs(value / 0.3 - 1.0))
    return spread(errors)


def torque_step_error() -> str:
    """Steps of the torque on the rigs, up and down: the inertia; and how many of level torques alone tell none."""
    errors, silent = [], 0
    for seed in SEEDS:
        torque = np.concatenate([np.full(3000, 12.0), np.full(2000, 3.0)] * 2)
        recording, truth = lm.rig.record(seed, torque_motor=torque, dt=DT)
        value = torque_step(recording).values.get("inertia")
        errors.append(np.inf if value is None else abs(value / sum(truth.drivetrain.inertias) - 1.0))
        level, _ = lm.rig.record(seed, torque_motor=np.full(6000, 12.0), dt=DT)
        silent += torque_step(level).values.get("inertia") is None
    return f"{spread(errors)}, {silent} of {len(SEEDS)} silent"


def spread(errors: list[float]) -> str:
    values = 100.0 * np.array(errors)
    found = values[np.isfinite(values)]
    missing = f", {len(values) - len(found)} none" if len(found) < len(values) else ""
    return f"{np.median(found):.3g} / {found.max():.3g} %{missing}" if len(found) else f"none{missing}"


RAMPS, ENCODERS = "identification.backlash.ramps", "identification.backlash.two_encoders"
BREAK, LADDER = "identification.friction.breakaway", "identification.friction.constant_speeds"
#: Module, constant, what is measured (median / largest error).
ROWS: tuple[tuple[str, str, Callable[[], str]], ...] = (
    *((RAMPS, name, locked_backlash_error) for name in ("REVERSAL", "CLEARANCE", "JUMP", "SWING")),
    *((ENCODERS, name, lost_motion_error) for name in ("CUTOFF", "TURNING", "IN_CONTACT")),
    *((BREAK, name, breakaway_error) for name in ("SMOOTHING", "MOVING", "LATE")),
    (LADDER, "STEADY", ladder_error),
    ("identification.friction.torque_step", "CONSTANT", torque_step_error),
)


def with_value(module: Any, name: str, value: float, measure: Callable[[], str]) -> str:
    own = getattr(module, name)
    setattr(module, name, value)
    try:
        return measure()
    finally:
        setattr(module, name, own)


def rows(wanted: list[str]) -> Iterator[str]:
    for path, name, measure in ROWS:
        if wanted and name not in wanted:
            continue
        module = import_module(f"lostmotion.{path}")
        own = getattr(module, name)
        tried = [with_value(module, name, factor * own, measure) for factor in (0.5, 1.0, 2.0)]
        yield f"| `{path.split('.')[-1]}.{name}` = {own:g} | " + " | ".join(tried) + " |"


if __name__ == "__main__":
    print("| constant | half | as it is | double |\n|---|---|---|---|")
    for line in rows(sys.argv[1:]):
        print(line, flush=True)

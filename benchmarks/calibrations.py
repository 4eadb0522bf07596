"""What the calibrated constants do: the error of a result with half, all and double of each, on stated recordings.

    python benchmarks/calibrations.py [NAME …]

Recordings: the virtual rigs 1 to 4 and two masses of Table I, seeds 1 to 4. Shown: median / largest error. A row whose
numbers hardly differ says that the constant may be anything near; comments at the constants quote this table.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import astuple, is_dataclass, replace
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.identification import (
    breakaway,
    friction_ladder,
    locked_backlash,
    lost_motion,
    rigid_drive,
    ring_down,
    torque_step,
)
from lostmotion.observers import extended_kalman, h_infinity, kalman, neural_network, sliding_mode
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


def identified(
    find: Callable[[Recording], Any], name: str, recordings: Callable[[], list[tuple[Recording, float]]]
) -> str:
    """Errors of one value, found in recordings that come with the true one."""
    found = [(find(recording).values[name], truth) for recording, truth in recordings()]
    return spread([np.inf if value is None else abs(value / truth - 1.0) for value, truth in found])


@cache
def two_encoders() -> list[tuple[Recording, float]]:
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
        made.append((Recording(t, signals), 0.003))
    return made


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


@cache
def ringing() -> list[Recording]:
    """Two steps of an oscillator of 28 Hz and 4 % damping, with noise of a tenth of the step."""
    made, t, w = [], np.arange(12_000) * DT, 2.0 * np.pi * 28.0
    for seed in range(1, 11):
        rng = np.random.default_rng(seed)
        y = 0.1 * rng.standard_normal(t.size)
        for start, height in ((4.0, 1.0), (8.0, -1.0)):
            u = np.maximum(t - start - rng.uniform(-0.2, 0.2), 0.0)
            y += height * (u > 0.0) * (1.0 - np.exp(-0.04 * w * u) * np.cos(w * np.sqrt(1.0 - 0.04**2) * u))
        made.append(Recording(t, {"torque_shaft": y}))
    return made


def ring_down_error() -> str:
    """Of frequency, then of the damping ratio; and how many of the intervals of the latter hold it."""
    found = [ring_down(recording) for recording in ringing()]
    of = {name: [np.inf if f.values[name] is None else abs(f.values[name] / truth - 1.0) for f in found]
          for name, truth in (("frequency", 28.0), ("damping_ratio", 0.04))}  # fmt: skip
    held = [f.intervals["damping_ratio"] for f in found if f.values["damping_ratio"] is not None]
    inside = sum(low <= 0.04 <= high for low, high in held)
    return f"{spread(of['frequency'])}; {spread(of['damping_ratio'])}, {inside} of {len(found)} held"


@cache
def emps() -> Recording:
    folder = Path(os.environ.get("LOSTMOTION_DATA", Path(__file__).parents[2] / "shared" / "data"))
    columns = {"position": "qm", "force": {"column": "vir", "scale": 35.1507}}
    return lm.read_recording(folder / "emps" / "DATA_EMPS.mat", time="t", channels=columns)


def emps_error() -> str:
    """Of the published inertia and Coulomb force of EMPS."""
    values = rigid_drive(emps(), angle="position", torque="force").values
    published = {"inertia": 95.1089, "coulomb": 20.3935, "viscous": 203.5034}
    return spread([abs((values[name] or np.inf) / value - 1.0) for name, value in published.items()])


@cache
def driven() -> list[tuple[Recording, Any]]:
    """Three seconds of excitation at 10 kHz on the rigs, motor speed and shaft torque, and the truth."""
    torque = lm.signals.excitation(3.0, 1e-4, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    return [lm.rig.record(s, torque_motor=torque, channels=("speed_motor", "torque_shaft")) for s in SEEDS]


def bursts(values: np.ndarray, fault: str, size: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Twenty milliseconds of a fault every 0.3 s; which samples are bad, and 20 ms from 50 ms after them."""
    shown, bad, after = values.copy(), np.zeros(values.size, bool), np.zeros(values.size, bool)
    for i, start in enumerate(range(6000, values.size - 1500, 3000)):
        burst = slice(start, start + 200)
        bad[burst] = after[start + 700 : start + 900] = True
        shown[burst] = shown[start - 1] if fault == "frozen" else shown[burst] + (-1) ** i * size
    return shown, bad, after


def observer_error(make: Callable[..., Any], fault: str = "", size: float = 8.0, off: float = 1.0) -> str:
    """Of the load speed, % of its range, rms (``off``: factor on the load inertia of its model); with a fault: how many
    times as large after bursts of it, and the share of bad and of good samples that are flagged."""
    errors, ratios, flagged = [], [], []
    for recording, truth in driven():
        plant = lm.Drivetrain.two_mass(**truth.parameters)
        law = make(
            plant.with_parameters(inertia_load=off * plant.inertia_load), dt=1e-4, speed_from_counts=True
        )
        data = {name: recording[name] for name in law.inputs}
        exact, clean = truth.signals["speed_load"], law.run(data)
        wrong = clean["speed_load_estimated"] - exact
        errors.append(rms(wrong[10000:]) / float(np.ptp(exact)))
        if fault:
            shown, bad, after = bursts(data["speed_motor"], fault, size)
            found = law.run({**data, "speed_motor": shown})
            ratios.append(rms((found["speed_load_estimated"] - exact)[after]) / rms(wrong[after]))
            flagged.append(
                (np.mean(found["input_fault"][bad] != 0), np.mean(found["input_fault"][~bad] != 0))
            )
    if not fault:
        return spread(errors)
    of_bad, of_good = 100.0 * np.mean(flagged, axis=0)
    return f"{np.median(ratios):.3g} / {max(ratios):.3g} times, flagged {of_bad:.3g} and {of_good:.2g} %"


def h_infinity_error() -> str:
    """Of the load speed with the true load inertia, and with one 20 % too small; the level is 1 + 0.1·factor."""
    module = import_module("lostmotion.observers.fixed_gain.h_infinity")
    # What counts is the distance from the smallest level.
    level = 1.0 + (module.MARGIN / 1.1) * 0.1
    make = partial(h_infinity, margin=level)
    return f"{observer_error(make)}; {observer_error(make, off=0.8)}"


@cache
def excited() -> list[tuple[Recording, Any]]:
    """The default excitation of the rigs 1 and 2, 5 s at 10 kHz."""
    return [(recording.window(0.0, 5.0), truth) for recording, truth in map(lm.rig.record, SEEDS[:2])]


#: Value, ends of its interval, true value.
Judged = tuple[float, float, float, float]


def judged(found: Any, truth: Any, names: Sequence[str]) -> Iterator[Judged]:
    """Those of ``names`` that were identified."""
    for name in names:
        if found.values[name] is not None:
            yield found.values[name], *found.intervals[name], truth.parameters[name]


def relative_errors(values: Sequence[Judged]) -> str:
    """Their spread, and how many intervals hold the true value."""
    inside = sum(low <= true <= high for _, low, high, true in values)
    errors = [abs(value / true - 1.0) for value, _, _, true in values]
    return f"{spread(errors)}, {inside} of {len(values)} in their interval"


def identification_error() -> str:
    """Of inertias, stiffness, backlash, Coulomb torque; how many of them identified, in their interval; warnings."""
    values: list[Judged] = []
    warnings = 0
    for recording, truth in excited():
        found = lm.identify(recording, start=NAMEPLATE)
        warnings += len(found.problems)
        values += judged(found, truth, ("inertia_motor", "inertia_load", "stiffness", "backlash", "coulomb"))
    return f"{relative_errors(values)}, {warnings} warnings"


def allowance_error() -> str:
    """Of damping, lag and Coulomb torque: errors over half widths, and how many are in their interval."""
    shares = []
    for recording, truth in excited():
        found = lm.identify(recording, start=NAMEPLATE)
        for value, low, high, true in judged(found, truth, ("damping", "lag", "coulomb")):
            shares.append(2.0 * abs(value - true) / (high - low))
    inside = sum(share <= 1.0 for share in shares)
    return (
        f"error over half width {np.median(shares):.2g} / {max(shares):.2g}, {inside} of {len(shares)} inside"
    )


def load_torque_error() -> str:
    """Of inertias, stiffness, backlash under a load torque of 1.5 Nm at 0.3 Hz; and how many in their interval."""
    values: list[Judged] = []
    torque = lm.signals.excitation(5.0, 1e-4, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    load = 1.5 * np.sin(2.0 * np.pi * 0.3 * 1e-4 * np.arange(torque.size))
    for seed in SEEDS[:2]:
        recording, truth = lm.rig.record(seed, torque_motor=torque, torque_load=load)
        found = lm.identify(recording, start=NAMEPLATE, load_torque=True)
        values += judged(found, truth, ("inertia_motor", "inertia_load", "stiffness", "backlash"))
    return relative_errors(values)


def contact_laws() -> str:
    """Laws of exact two masses that are found, of each law on two seeds; the others cannot be distinguished."""
    found = []
    for law in ("viscoelastic", "dead_zone"):
        plant = lm.Drivetrain.two_mass(**{**TABLE_I, "lag": 3e-4}).with_contact(law)
        for seed in SEEDS[:2]:
            torque = lm.signals.excitation(3.0, 2e-4, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
            run = lm.simulate(plant, torque_motor=torque, dt=2e-4)
            speed = np.diff(counted(run["angle_motor"], 18, np.random.default_rng(seed)), prepend=0.0) / 2e-4
            speed[0] = 0.0
            signals = {"torque_motor": torque, "speed_motor": speed}
            recording = Recording(run.time, signals, meta={"speed_from_counts": True})
            chosen = lm.identification.compare_contacts(recording, start=NAMEPLATE).better
            found.append("none" if chosen is None else "right" if chosen == law else "wrong")
    return ", ".join(f"{found.count(word)} {word}" for word in ("right", "wrong", "none"))


def default_poles_apart() -> str:
    """Fastest over slowest default pole, the slowest over the torsional mode: Table I with gap and lag × 1 and × 3."""
    from lostmotion.stages.target_law import default_poles

    apart, slowest = [], []
    for gap, lag in ((1.0, 1.0), (3.0, 1.0), (1.0, 3.0), (3.0, 3.0)):
        plant = lm.Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.012 * gap, "lag": 3e-4 * lag})
        sizes = np.abs(default_poles(plant, 1e-4, False).values)
        apart.append(float(np.max(sizes) / np.min(sizes)))
        slowest.append(float(np.min(sizes)) / (2.0 * np.pi * plant.pole_frequency))
    return f"{np.median(apart):.3g} / {max(apart):.3g}, slowest {np.median(slowest):.2g} of the mode"


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def twist_error() -> str:
    """Of the load speed, % of its range, of an observer of speed and twist at 1 ms on two masses without noise."""
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    torque = lm.signals.excitation(5.0, DT, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(plant, dt=DT, torque_motor=torque)
    law = lm.observers.kalman(plant, measured=("speed_motor", "twist"), dt=DT)
    found = law.run({name: run[name] for name in law.inputs})["speed_load_estimated"]
    return spread([rms((found - run["speed_load"])[1000:]) / float(np.ptp(run["speed_load"]))])


def turn_limit() -> str:
    """Largest error of the load speed, % of its range, at the sample time in which the closed mode turns so far."""
    module = import_module("lostmotion.observers.fixed_gain.sampled_model")
    limit, errors = module.LARGEST_TURN, []
    for factor, gap in ((1.0, 0.012), (0.1, 0.012), (1.0, 0.003), (10.0, 0.03)):
        plant = lm.Drivetrain.two_mass(**{**TABLE_I, "stiffness": factor * 6285.896, "backlash": gap})
        dt = limit / module.mode_rate(plant)
        torque = lm.signals.excitation(20.0, dt, seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
        run = lm.simulate(plant, dt=dt, torque_motor=torque)
        law = lm.observers.kalman(plant, dt=dt)
        with np.errstate(all="ignore"):
            found = law.run({name: run[name] for name in law.inputs})["speed_load_estimated"]
        errors.append(float(np.max(np.abs(found - run["speed_load"]))) / float(np.ptp(run["speed_load"])))
    return spread(errors)


@cache
def closed_shaft() -> list[tuple[Recording, np.ndarray]]:
    made = []
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.01, inertia_load=0.02, stiffness=110.0, coulomb=0.3, viscous=0.01
    )
    for seed in SEEDS:
        rng = np.random.default_rng(seed)
        exact = lm.simulate(
            plant, dt=DT, torque_motor=3.0 + lm.signals.noise(1.0, 60.0, 1.0, 4.0, DT, seed=seed)
        )
        shown = {"speed_motor": 0.01, "torque_shaft": 0.02}
        shown = {name: exact[name] + size * rng.standard_normal(len(exact)) for name, size in shown.items()}
        made.append((Recording(exact.time, shown), exact["speed_load"]))
    return made


def shaft_torque_error() -> str:
    """After jumps of 5 Nm for 2 ms and zeros for 20 ms: the load speed's error against that without a fault."""
    ratios = []
    for recording, exact in closed_shaft():
        law = lm.observers.shaft_torque(110.0, dt=DT)
        clean = law.run(recording)["speed_load_estimated"] - exact
        for length, zero in ((2, False), (20, True)):
            torque, after = recording["torque_shaft"].copy(), np.zeros(exact.size, bool)
            for start in range(600, 3800, 300):
                burst = slice(start, start + length)
                torque[burst] = 0.0 if zero else torque[burst] + 5.0
                after[start + length : start + length + 50] = True
            found = law.run({"speed_motor": recording["speed_motor"], "torque_shaft": torque})
            ratios.append(rms((found["speed_load_estimated"] - exact)[after]) / rms(clean[after]))
    return f"{np.median(ratios):.3g} / {max(ratios):.3g} times"


def fault_warnings() -> str:
    """Warnings of the rigs' own recordings, then of the same with a speed that sticks, is dead, or has a spike."""
    from lostmotion.io.recordings import signal_faults

    counts = np.zeros(4, int)
    for recording, _ in driven():
        for kind in range(4):
            speed = recording["speed_motor"].copy()
            if kind == 1:
                speed[8000:8300] = speed[8000]
            elif kind == 2:
                speed[9000:15000] = 0.0
            elif kind == 3:
                speed[7777] += 20000.0 * float(np.std(np.diff(speed)))
            signals = {name: speed if name == "speed_motor" else recording[name] for name in recording}
            counts[kind] += bool(
                signal_faults.stuck("speed_motor", speed, recording, "")
                + signal_faults.dead(signals, recording.time, "")
                + signal_faults.spikes("speed_motor", speed, recording, "")
            )
    clean, *found = counts
    return f"{clean} false, found " + " ".join(f"{n} of {len(SEEDS)}" for n in found)


def spread(errors: list[float]) -> str:
    values = 100.0 * np.array(errors)
    found = values[np.isfinite(values)]
    missing = f", {len(values) - len(found)} none" if len(found) < len(values) else ""
    return f"{np.median(found):.3g} / {found.max():.3g} %{missing}" if len(found) else f"none{missing}"


NAMEPLATE = lm.Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.01, "coulomb": 1.5})
RAMPS, ENCODERS = "identification.backlash.ramps", "identification.backlash.two_encoders"
FAULTS, SPEED = "io.recordings.signal_faults", "observers.motor_speed.parameters"
TORQUE, TWO_MASS = "observers.fixed_gain.shaft_torque", "observers.filters.two_mass_parameters"
BREAK, LADDER = "identification.friction.breakaway", "identification.friction.constant_speeds"
#: Constants that are ratios above one.
RATIOS = ("RIVAL_COST", "MUCH_WORSE")
#: Module, constant, what is measured (median / largest error).
ROWS: tuple[tuple[str, str, Callable[[], str]], ...] = (
    *(
        (RAMPS, name, partial(identified, locked_backlash, "backlash", locked_loads))
        for name in ("REVERSAL", "CLEARANCE", "JUMP", "SWING")
    ),
    *(
        (ENCODERS, name, partial(identified, lost_motion, "backlash", two_encoders))
        for name in ("CUTOFF", "TURNING", "IN_CONTACT")
    ),
    *(
        (BREAK, name, partial(identified, breakaway, "breakaway_plus", starts))
        for name in ("SMOOTHING", "MOVING", "LATE")
    ),
    (LADDER, "STEADY", ladder_error),
    *(
        (f"identification.prediction_error.{file}", name, identification_error)
        for file, name in (
            ("initial_values", "RIGID_BAND"),
            ("model_error", "PEAK_SHARE"),
            ("identifiability", "CONTRADICTION"),
            ("bootstrap", "FIRST"),
            ("warnings", "COARSE"),
            ("warnings", "SAMPLES_PER_PERIOD"),
            ("warnings", "NOT_WHITE"),
            ("initial_values", "RIVAL_COST"),
            ("initial_values", "RIVAL_DISTANCE"),
        )
    ),
    *(
        ("identification.prediction_error.model_error", name, allowance_error)
        for name in ("DAMPING_ALLOWANCE", "LAG_ALLOWANCE", "FRICTION_ALLOWANCE")
    ),
    ("identification.prediction_error.gain_schedule", "LADDER", identification_error),
    ("identification.prediction_error.noise_levels", "LOAD_RATES", load_torque_error),
    ("identification.prediction_error.noise_levels", "MUCH_WORSE", load_torque_error),
    ("stages.target_law", "FASTEST", default_poles_apart),
    ("identification.prediction_error.contact_comparison", "LEAST_GAIN", contact_laws),
    ("identification.friction.torque_step", "CONSTANT", torque_step_error),
    ("identification.friction.inverse_dynamics", "SIGN_CUTOFF", emps_error),
    ("identification.shaft.ring_down", "STEP_WINDOW", ring_down_error),
    *(
        (FAULTS, name, fault_warnings)
        for name in ("STUCK_RUNS", "STUCK_TIME", "DEAD_SHARE", "DEAD_TORQUE", "SPIKE")
    ),
    ("observers.fixed_gain.sampled_model", "LARGEST_TURN", turn_limit),
    ("observers.fixed_gain.h_infinity", "MARGIN", h_infinity_error),
    (
        "observers.fixed_gain.gates",
        "OPEN_AT",
        partial(observer_error, partial(kalman, contact_scheduling=True)),
    ),
    *(
        ("observers.fixed_gain.shaft_torque", name, shaft_torque_error)
        for name in ("TORQUE_DEVIATIONS", "HOLD", "MEMORY")
    ),
    *(
        (SPEED, name, partial(observer_error, sliding_mode, "jump"))
        for name in ("JUMP_LIMIT", "JUMP_LIMIT_RATE")
    ),
    ("observers.motor_speed.neural_network", "INNOVATION", partial(observer_error, neural_network, off=0.8)),
    (TWO_MASS, "EIGENMODE_TURN", partial(observer_error, extended_kalman)),
    *(
        (TWO_MASS, name, partial(observer_error, extended_kalman, "jump"))
        for name in ("GATE", "LARGEST_DEVIATION")
    ),
)


def with_value(module: Any, name: str, value: Any, measure: Callable[[], str]) -> str:
    """``measure`` with another value of a module's constant, also where other modules have imported it."""
    own = getattr(module, name)
    holders = [m for m in list(sys.modules.values()) if m is module or vars(m).get(name) is own]
    for holder in holders:
        setattr(holder, name, value)
    try:
        return measure()
    finally:
        for holder in holders:
            setattr(holder, name, own)


def scaled(value: Any, factor: float) -> Any:
    """A number times a factor, or all numbers of a tuple or a dataclass."""
    if isinstance(value, tuple):
        return tuple(scaled(part, factor) for part in value)
    if is_dataclass(value) and not isinstance(value, type):
        return type(value)(*(factor * number for number in astuple(value)))
    return factor * value


def rows(wanted: list[str]) -> Iterator[str]:
    for path, name, measure in ROWS:
        if wanted and name not in wanted:
            continue
        module = import_module(f"lostmotion.{path}")
        own = getattr(module, name)
        # Of a ratio that is above one, what it is above one counts.
        values = [1.0 + f * (own - 1.0) if name in RATIOS else scaled(own, f) for f in (0.5, 1.0, 2.0)]
        tried = [with_value(module, name, value, measure) for value in values]
        size = own if isinstance(own, tuple) else f"{own:g}"
        yield f"| `{path.split('.')[-1]}.{name}` = {size} | " + " | ".join(tried) + " |"


if __name__ == "__main__":
    print("| constant | half | as it is | double |\n|---|---|---|---|")
    for line in rows(sys.argv[1:]):
        print(line, flush=True)

"""Observers on the virtual rig: torque sensor, entries of Q, covariances, faults.

    python benchmarks/observers.py --seeds 20 --out figures

Prints Markdown tables; with --out a figure goes there. Parts can be chosen: --only torque-sensor weights covariances.
The leaderboard: docs/make_observer_leaderboard.py.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from shared import parser_of

import lostmotion as lm
from lostmotion.compare import CASES, CONTESTANTS
from lostmotion.compare.experiment import Experiment, experiment
from lostmotion.compare.scores import score
from lostmotion.compare.statistics import median
from lostmotion.observers import covariances, kalman, shaft_torque
from lostmotion.observers.analysis.covariances import SEARCHED

PARTS = ("torque-sensor", "weights", "covariances", "faults")
CASE = {case.name: case for case in CASES}
DURATION = 3.0
NOISE = (0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
FACTORS = (0.01, 0.1, 10.0, 100.0)
TRIED = ("nominal", "inertia_load −20 %", "load torque 3 Nm")


def errors(law: Any, data: Experiment) -> tuple[float, float, float]:
    """Load speed and shaft torque (fraction of range), F1 of the gap."""
    found = score(law, data)
    return tuple(float(found[name] or 0.0) for name in ("speed_load", "torque_shaft", "f1_gap"))  # type: ignore[return-value]


def observer(data: Experiment, **options: Any) -> Any:
    return kalman(data.drivetrain, dt=data.sensing.dt, speed_from_counts=True, **options)


def torque_sensor(seed: int) -> list[tuple[float, float]]:
    """log of Observer 2's error over Observer 1's for load speed and shaft torque, for each noise."""
    rows = []
    for noise in NOISE:
        data = experiment(replace(CASE["nominal"], torque_noise=noise), seed, DURATION)
        one = errors(observer(data), data)
        two = errors(observer(data, measured=("torque_shaft", "speed_motor")), data)
        rows.append((float(np.log(two[0] / one[0])), float(np.log(two[1] / one[1]))))
    return rows


def weights(seed: int) -> dict[str, list[tuple[float, float, float]]]:
    """Errors with the paper's Q and with each entry multiplied by a factor."""
    data = {name: experiment(CASE[name], seed, DURATION) for name in TRIED}
    rows = {"paper": [errors(observer(d), d) for d in data.values()]}
    for state, value in (("twist", 1.0), ("speed_motor", 1000.0), ("speed_load", 1000.0)):
        for factor in FACTORS:
            changed = {state: factor * value}
            rows[f"{state} × {factor:g}"] = [
                errors(observer(d, process_covariance=changed), d) for d in data.values()
            ]
    return rows


def covariances_of_rig(seed: int) -> tuple[dict[str, list[tuple[float, float, float]]], dict[str, float]]:
    """Errors with the paper's covariances and with those from another recording, and the sensitivities."""
    recording, truth = lm.rig.record(seed, noise_seed=3)
    plant = lm.Drivetrain.two_mass(**truth.parameters)
    found = covariances(recording.window(0.0, 3.0), plant, speed_from_counts=True)
    data = {name: experiment(CASE[name], seed, DURATION) for name in TRIED}
    own = {"process_covariance": found.process, "measurement_covariance": found.measurement}
    rows = {
        "paper": [errors(observer(d), d) for d in data.values()],
        "from data": [errors(observer(d, **own), d) for d in data.values()],
    }
    noise = {name: float(np.sqrt(found.process[name])) for name in SEARCHED}
    noise["sensor"] = float(np.sqrt(found.measurement["speed_motor"] / recording.dt))
    return rows, {**noise, **{f"curvature {n}": v for n, v in found.sensitivity.items()}}


#: Faults of a measured signal: duration (s), and value instead of y; one every 0.3 s from 0.6 s on.
FAULTS: dict[str, tuple[float, Callable[[np.ndarray], Any]]] = {
    "NaN, 20 ms": (0.02, lambda y: np.nan),
    "frozen, 20 ms": (0.02, lambda y: y[0]),
    "zero, 20 ms": (0.02, lambda y: 0.0),
    "+200, 2 ms": (0.002, lambda y: y + 200.0),
    "+5, 2 ms": (0.002, lambda y: y + 5.0),
}
DROPPED = "5 % dropped"
#: The same of the motor's torque, and of all inputs at once.
NO_TORQUE, NOTHING, SOME = "torque_motor NaN, 20 ms", "all inputs NaN, 20 ms", "all inputs, 5 % dropped"


def broken(values: np.ndarray, fault: str, dt: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The signal with its faults, its bad samples, and the judged ones: 50 to 70 ms after each fault."""
    first, shown = round(0.6 / dt), values.copy()
    bad, after = np.zeros(values.size, dtype=bool), np.zeros(values.size, dtype=bool)
    if fault == DROPPED:
        bad[first:] = np.random.default_rng(1).random(values.size - first) < 0.05
        shown[bad] = np.nan
        return shown, bad, ~bad & (np.arange(values.size) >= first)
    length, show = FAULTS[fault]
    for k in range(first, values.size - round(0.15 / dt), round(0.3 / dt)):
        end = k + max(1, round(length / dt))
        shown[k:end] = show(shown[k:end])
        bad[k:end] = True
        after[end + round(0.05 / dt) : end + round(0.07 / dt)] = True
    return shown, bad, after


def after_faults(
    law: Any, recording: lm.Recording, load: np.ndarray, signal: str
) -> list[tuple[float, float]]:
    """For each fault of the signal, of the torque and of all inputs: error of the load speed over the normal one.

    Beside it the share of the bad samples that is flagged.
    """
    estimates = law.run(recording.only(*law.inputs))
    if "input_fault" not in estimates:
        return []
    normal = np.sqrt(np.mean((estimates["speed_load_estimated"] - load)[round(0.3 / recording.dt) :] ** 2))
    cells = []
    missing = next(iter(FAULTS))
    trials: list[tuple[tuple[str, ...], str]] = [((signal,), fault) for fault in (*FAULTS, DROPPED)]
    trials += [(("torque_motor",), missing), (law.inputs, missing), (law.inputs, DROPPED)]
    for names, fault in trials:
        if not set(names) <= set(law.inputs):
            cells.append((np.nan, np.nan))
            continue
        shown = {name: broken(recording[name], fault, recording.dt)[0] for name in names}
        _, bad, after = broken(recording[names[0]], fault, recording.dt)
        found = law.run(recording.with_signals("simulated", **shown).only(*law.inputs))
        error = np.sqrt(np.mean((found["speed_load_estimated"] - load)[after] ** 2))
        cells.append((float(error / normal), float(np.mean(found["input_fault"][bad]))))
    return cells


def closed_shaft(seed: int) -> tuple[lm.Recording, np.ndarray]:
    """Motor speed and torque of a closed shaft at 1 ms, with noise of 0.01 rad/s and 0.02 Nm; speed of the load."""
    shaft = lm.Drivetrain.two_mass(
        inertia_motor=0.01, inertia_load=0.02, stiffness=110.0, coulomb=0.3, viscous=0.01
    )
    torque = 3.0 + lm.signals.noise(1.0, 60.0, 1.0, DURATION, 1e-3, seed=seed)
    exact, rng = lm.simulate(shaft, dt=1e-3, torque_motor=torque), np.random.default_rng(seed)
    noise = {"speed_motor": 0.01, "torque_shaft": 0.02}
    shown = {name: exact[name] + size * rng.standard_normal(torque.size) for name, size in noise.items()}
    return lm.Recording(time=exact.time, signals=shown), exact["speed_load"]


def faults(seed: int) -> dict[str, list[tuple[float, float]]]:
    """Rows of the table for every observer and each signal that it measures."""
    data = experiment(CASE["nominal"], seed, DURATION)
    trials = [
        (e.name, e.make(data.drivetrain, data.sensing), data.recording, data.truth["speed_load"])
        for e in CONTESTANTS
    ]
    trials.append(("shaft torque alone (1 ms)", shaft_torque(110.0, dt=1e-3), *closed_shaft(seed)))
    rows = {}
    for name, law, recording, load in trials:
        measured = [signal for signal in law.inputs if signal != "torque_motor"]
        for signal in measured:
            label = f"{name}: {signal}" if len(measured) > 1 else name
            rows[label] = after_faults(law, recording, load, signal)
    return {label: cells for label, cells in rows.items() if cells}


def print_faults(results: list[dict[str, list[tuple[float, float]]]]) -> None:
    rows = []
    for name in results[0]:
        values = np.array([r[name] for r in results])
        middle, worst = np.median(values, axis=0), values[..., 0].max(axis=0)
        cells = (f"{m[0]:.1f} ({w:.1f}), {100 * m[1]:.0f} %" for m, w in zip(middle, worst, strict=True))
        rows.append([name, *("–" if "nan" in text else text for text in cells)])
    print(
        table(
            [
                "error after / normal error: median (worst rig), flagged",
                *(*FAULTS, DROPPED, NO_TORQUE, NOTHING, SOME),
            ],
            rows,
        )
    )


def over_seeds(job: Callable[[int], Any], seeds: int) -> list[Any]:
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(job, range(1, seeds + 1)))


def cell(values: Any, scale: float = 100.0, digits: int = 3) -> str:
    found = median(list(values))
    return f"{scale * found.value:.{digits}g} ({scale * found.low:.{digits}g} to {scale * found.high:.{digits}g})"


def table(head: list[str], rows: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(row) + " |" for row in [head, ["---"] * len(head), *rows])


def print_torque_sensor(seeds: int, out: Path | None) -> None:
    logs = np.array(over_seeds(torque_sensor, seeds))  # seed, noise, signal
    names = ("load speed", "shaft torque")
    ratios = {
        name: [
            tuple(np.exp([e.value, e.low, e.high]))
            for e in (median(logs[:, i, j]) for i in range(len(NOISE)))
        ]
        for j, name in enumerate(names)
    }
    rows = [
        [
            f"{noise:g}",
            *(f"{ratios[n][i][0]:.2f} ({ratios[n][i][1]:.2f} to {ratios[n][i][2]:.2f})" for n in names),
        ]
        for i, noise in enumerate(NOISE)
    ]
    print(table(["torque sensor, Nm", *(f"{n}: Observer 2 / Observer 1" for n in names)], rows))
    even: dict[str, float | None] = {}
    for j, name in enumerate(names):
        levels = [crossing(logs[s, :, j]) for s in range(seeds)]
        known = [level for level in levels if level is not None]
        even[name] = float(np.median(known)) if len(known) > seeds / 2 else None
        print(
            f"\nbreak-even, {name}: {cell(known, 1.0) if known else 'none'} Nm, in {len(known)} of {seeds} rigs"
        )
    if out is not None:
        lm.plot.sensor_worth(NOISE, ratios, even).savefig(out / "torque_sensor.svg")


def crossing(logs: np.ndarray) -> float | None:
    """Noise at which the ratio goes through 1, on the straight line between logarithms."""
    above = np.flatnonzero(logs > 0.0)
    if above.size == 0 or above[0] == 0:
        return None
    i = int(above[0])
    share = -logs[i - 1] / (logs[i] - logs[i - 1])
    return float(NOISE[i - 1] * (NOISE[i] / NOISE[i - 1]) ** share)


def print_errors(results: list[dict[str, list[tuple[float, float, float]]]]) -> None:
    head = ["Q", *(f"{case}: load speed %, shaft torque %, F1" for case in TRIED)]
    rows = []
    for name in results[0]:
        values = np.median([r[name] for r in results], axis=0)
        rows.append([name, *(f"{100 * v[0]:.2f}, {100 * v[1]:.2f}, {v[2]:.3f}" for v in values)])
    print(table(head, rows))


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="rigs 1 to SEEDS")
    parser.add_argument("--out", type=Path, help="folder for the figure")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS))
    arguments = parser.parse_args()
    seeds, out = arguments.seeds, arguments.out
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    if "torque-sensor" in arguments.only:
        print("\n### Torque sensor\n")
        print_torque_sensor(seeds, out)
    if "weights" in arguments.only:
        print("\n### Entries of Q\n")
        print_errors(over_seeds(weights, seeds))
    if "covariances" in arguments.only:
        print("\n### Covariances from a recording\n")
        found = over_seeds(covariances_of_rig, seeds)
        print_errors([rows for rows, _ in found])
        print()
        print(
            table(["found", "median (95 %)"], [[n, cell([v[n] for _, v in found], 1.0)] for n in found[0][1]])
        )
    if "faults" in arguments.only:
        print("\n### Faults of the sensors\n")
        print_faults(over_seeds(faults, seeds))


if __name__ == "__main__":
    main()

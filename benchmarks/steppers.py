"""The observers that are steppers on the virtual rig, after identification, beside Observer 1.

    python benchmarks/steppers.py --seeds 20     # accuracy, gap, backlash online, cost: a Markdown table of medians
    python benchmarks/steppers.py --wear         # the backlash grows by 10 % in 10 s: error from 1 s on, all cores

Each rig is identified from 10 s of the default excitation, with nameplate values 30 % off, and judged on 5 s of another
one, from 0.5 s on. The backlash online starts 50 % too small and 50 % too large; the error is the larger one after 5 s.
Cost: process time per sample, median of the seeds.
"""

from __future__ import annotations

import os
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
from shared import parser_of

import lostmotion as lm
from lostmotion.recording import Recording
from lostmotion.signals import excitation

DT = 1e-4
SPEED_NOISE = 0.03
MAKERS = (
    lm.observers.kalman,
    lm.observers.extended_kalman,
    lm.observers.unscented_kalman,
    lm.observers.interacting_models,
    lm.observers.moving_horizon,
    lm.observers.sliding_mode,
    lm.observers.super_twisting,
    lm.observers.neural_network,
)
#: Observers that track the backlash of a joint with wear.
WEARING = (lm.observers.extended_kalman, lm.observers.unscented_kalman, lm.observers.moving_horizon)


def experiment(seed: int, duration: float, signal_seed: int):
    torque = excitation(duration, DT, seed=signal_seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    return lm.rig.record(seed, torque_motor=torque)


def score(result: Recording, exact: Recording, backlash: float) -> list[float]:
    """RMSE of load speed and shaft torque in % of range, F1 of the gap."""
    row = []
    for name in ("speed_load", "torque_shaft"):
        truth = exact[name][5000:]
        error = result[f"{name}_estimated"][5000:] - truth
        row.append(100.0 * np.sqrt(np.mean(error**2)) / np.ptp(truth))
    reported = result["twist_elastic_estimated"][5000:] == 0.0
    gap = np.abs(exact["twist_3"][5000:]) < 0.5 * backlash
    return [*row, 2.0 * np.sum(reported & gap) / (np.sum(reported) + np.sum(gap))]


def one_seed(seed: int) -> dict[str, list[float]]:
    first, truth = experiment(seed, 10.0, seed)
    rng = np.random.default_rng([seed, 9])
    nameplate = {n: v * 1.3 ** rng.choice([-1.0, 1.0]) for n, v in truth.parameters.items()}
    found = lm.identify(first, start=lm.Drivetrain.two_mass(**nameplate)).drivetrain
    found = replace(found, actuator=replace(found.actuator, torque_limit=lm.rig.TORQUE_LIMIT))
    second, truth = experiment(seed, 5.0, 1000 + seed)
    given, backlash = second.only("torque_motor", "speed_motor"), truth.parameters["backlash"]
    table = {}
    for make in MAKERS:
        observer = make(found, dt=DT, speed_from_counts=True)
        observer.run(given.window(0.0, 0.01))  # compiles
        start = time.process_time()
        result = observer.run(given)
        cost = (time.process_time() - start) / len(given) * 1e9
        online = []
        if "backlash_estimated" in result:
            for factor in (0.5, 1.5):
                off = found.with_parameters(backlash=factor * backlash)
                end = make(off, dt=DT, speed_from_counts=True).run(given)["backlash_estimated"][-1]
                online.append(100.0 * abs(end / backlash - 1.0))
        table[make.__name__] = [*score(result, truth.signals, backlash), max(online, default=np.nan), cost]
    return table


def wear(seed: int) -> list[tuple[float, float]]:
    """Errors of the backlash in %, for each of WEARING: the largest from 1 s on, and at the end.

    100 segments of 0.1 s, each with a backlash 0.1 % of the start larger; sines of 9 and 2.3 Hz, 12 and 4 Nm.
    """
    new = lm.rig.varied_rig(seed).drivetrain
    joint = next(i for i, shaft in enumerate(new.shafts) if shaft.has_backlash)
    _, truth = experiment(seed, 4.0, seed)
    found = []
    for make in WEARING:
        estimator = make(lm.Drivetrain.two_mass(**truth.parameters), dt=DT)
        rng = np.random.default_rng([seed, 3])
        state, final, errors = None, None, []
        for piece in range(100):
            worn = replace(new.shafts[joint], backlash=new.shafts[joint].backlash * (1.0 + 0.001 * piece))
            t = (piece * 1000 + np.arange(1000)) * DT
            torque = 12.0 * np.sin(2.0 * np.pi * 9.0 * t) + 4.0 * np.sin(2.0 * np.pi * 2.3 * t)
            plant = replace(new, shafts=(*new.shafts[:joint], worn, *new.shafts[joint + 1 :]))
            exact = lm.simulate(plant, dt=DT, torque_motor=torque, state=final)
            speed = exact["speed_motor"] + SPEED_NOISE * rng.normal(size=1000)
            result = estimator.run({"torque_motor": torque, "speed_motor": speed}, state=state)
            final, state = exact.final_state, result.final_state["state"]
            errors.append(100.0 * np.max(np.abs(result["backlash_estimated"] / worn.backlash - 1.0)))
        found.append((max(errors[10:]), errors[-1]))
    return found


def print_wear(seeds: range) -> None:
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        rows = np.array(list(pool.map(wear, seeds)))
    print("| observer | largest from 1 s on %: median | worst rig | at the end %: median | worst rig |")
    print("|---|---|---|---|---|")
    for i, make in enumerate(WEARING):
        middle, worst = np.median(rows[:, i], axis=0), np.max(rows[:, i], axis=0)
        print(f"| {make.__name__} | {middle[0]:.2f} | {worst[0]:.2f} | {middle[1]:.2f} | {worst[1]:.2f} |")


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--wear", action="store_true")
    arguments = parser.parse_args()
    seeds = range(1, arguments.seeds + 1)
    if arguments.wear:
        print_wear(seeds)
        return
    tables = [one_seed(seed) for seed in seeds]
    print(
        "| observer | load speed % | shaft torque % | F1 gap | backlash online % | worst seed % | ns per sample |"
    )
    print("|---|---|---|---|---|---|---|")
    for make in MAKERS:
        rows = np.array([table[make.__name__] for table in tables])
        middle, worst = np.median(rows, axis=0), np.max(rows[:, 3])
        online = "–" if np.isnan(worst) else f"{middle[3]:.2f}"
        last = "–" if np.isnan(worst) else f"{worst:.2f}"
        print(
            f"| {make.__name__} | {middle[0]:.3f} | {middle[1]:.2f} | {middle[2]:.3f} | {online} | {last} "
            f"| {middle[4]:.0f} |"
        )


if __name__ == "__main__":
    main()

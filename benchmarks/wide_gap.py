"""Observers on a shaft whose gap is ever wider against its wind-up.

    python benchmarks/wide_gap.py      # a Markdown table: median (worst) of six excitations; a minute on one core

The paper's rig with a stiffer shaft, true parameters, under a contact law that is not the observers'; 20-bit encoder.
"""

from __future__ import annotations

import math

import numpy as np
from shared import TABLE_I

import lostmotion as lm
from lostmotion.simulation import Sensor, measure

DT, SECONDS, FIRST = 1e-4, 3.0, 3000
STIFFNESS = (TABLE_I["stiffness"], 2e4, 5e4, 1e5)
LEVELS = (4.0, 10.0, -4.0, -10.0, 6.0, -6.0)
MAKERS = (
    lm.observers.kalman,
    lm.observers.moving_horizon,
    lm.observers.neural_network,
    lm.observers.interacting_models,
    lm.observers.sliding_mode,
    lm.observers.super_twisting,
    lm.observers.extended_kalman,
    lm.observers.unscented_kalman,
)


def errors(stiffness: float, seed: int) -> tuple[float, list[float]]:
    """Torque that winds the shaft by its backlash over the working torque; load speed in % of range, each observer."""
    damping = TABLE_I["damping"] * math.sqrt(stiffness / TABLE_I["stiffness"])
    parameters = {**TABLE_I, "stiffness": stiffness, "damping": damping}
    torque = lm.signals.excitation(
        SECONDS, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175, levels=LEVELS, ramp=0.1,
        noise_rms=7.0, limit=1e9,
    )  # fmt: skip
    exact = lm.simulate(lm.Drivetrain.two_mass(**parameters, contact="dead_zone"), dt=DT, torque_motor=torque)
    sensors = {"speed_motor": Sensor("angle_motor", 2.0 * math.pi / 2**20, difference=True)}
    shown = {"torque_motor": torque, **measure(sensors, exact.signals, DT, seed)}
    load, row = exact["speed_load"][FIRST:], []
    for make in MAKERS:
        found = make(lm.Drivetrain.two_mass(**parameters), dt=DT, speed_from_counts=True).run(shown)
        wrong = found["speed_load_estimated"][FIRST:] - load
        row.append(float(100.0 * np.sqrt(np.mean(wrong**2)) / np.ptp(load)))
    return stiffness * parameters["backlash"] / float(np.sqrt(np.mean(torque**2))), row


def main() -> None:
    columns = []
    for stiffness in STIFFNESS:
        runs = [errors(stiffness, seed) for seed in range(1, 7)]
        columns.append((np.median([ratio for ratio, _ in runs]), np.array([row for _, row in runs])))
    print("| stiffness·backlash over torque |", " | ".join(f"{ratio:.0f}" for ratio, _ in columns), "|")
    print("|---" * (len(columns) + 1) + "|")
    for i, make in enumerate(MAKERS):
        cells = (f"{np.median(rows[:, i]):.2g} ({rows[:, i].max():.2g})" for _, rows in columns)
        print(f"| {make.__name__} |", " | ".join(cells), "|")


if __name__ == "__main__":
    main()

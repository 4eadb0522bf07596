"""Standard deviations of the observers against their errors.

    python benchmarks/standard_deviations.py --seeds 20

How often the truth lies within twice the standard deviation (Gauss: 95 %), and the standard deviation's root mean
square over that of the error; 3 s. First on a plant that is the observers' own model, with given noises and without
further eigenmodes (every standard deviation should be right), then on the virtual rig, which has further eigenmodes, in
three cases of the leaderboard: hard reversals, a load that rests half of the time, speed control.
"""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np
from shared import parser_of

import lostmotion as lm
from lostmotion.compare import CASES
from lostmotion.compare.experiment import experiment
from lostmotion.observers.filters.tuning import PROCESS_TORQUE

DT, DURATION = 1e-4, 3.0
FILTERS = (
    lm.observers.extended_kalman,
    lm.observers.unscented_kalman,
    lm.observers.interacting_models,
    lm.observers.moving_horizon,
)
SIGNALS = ("speed_load", "torque_shaft")
WORK = ("nominal", "sticking", "under control")
#: Of one sample, on the model as plant: torques (Nm) and motor speed (rad/s).
NOISE = {name: level / DT**0.5 for name, level in PROCESS_TORQUE.items()}
SENSOR = 0.03
#: Smaller errors are rounding: in the gap the shaft torque is zero.
ROUNDING = 1e-9


def of_fixed_gain(law, given, process, measurement, **options):
    deviations = lm.observers.standard_deviations(
        law, given, process_covariance=process, measurement_covariance=measurement, **options
    )
    return law.run(given), deviations


def judged(estimate, deviations, truth, rows) -> list[tuple[float, float]]:
    """(share within two standard deviations, standard deviation over error) of each signal."""
    found = []
    for signal in SIGNALS:
        error = (estimate[f"{signal}_estimated"] - truth[signal])[rows]
        deviation = deviations[f"{signal}_deviation"][rows]
        found.append(
            (float(np.mean(np.abs(error) <= 2.0 * deviation + ROUNDING)), float(rms(deviation) / rms(error)))
        )
    return found


def rms(values) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def physical_noises(plant) -> tuple[dict[str, float], dict[str, float]]:
    """Process and measurement covariance of ``PROCESS_TORQUE`` on both inertias and SENSOR."""
    process = {
        f"speed_{place}": (PROCESS_TORQUE[place] / inertia) ** 2
        for place, inertia in (("motor", plant.inertia_motor), ("load", plant.inertia_load))
    }
    return process, {"speed_motor": SENSOR**2 * DT}


def on_the_model(seed: int) -> dict[str, list[tuple[float, float]]]:
    plant = lm.Drivetrain.two_mass(**lm.rig.record(seed)[1].parameters)
    torque = lm.signals.excitation(
        DURATION, DT, seed=seed, inertia=0.1292, coulomb=plant.coulomb, viscous=plant.viscous
    )
    rng = np.random.default_rng([seed, 3])
    true = lm.simulate(
        plant, dt=DT, torque_motor=torque + NOISE["motor"] * rng.normal(size=torque.size),
        torque_load=NOISE["load"] * rng.normal(size=torque.size),
    )  # fmt: skip
    given = {
        "torque_motor": torque,
        "speed_motor": true["speed_motor"] + SENSOR * rng.normal(size=torque.size),
    }
    rows = slice(3000, None)
    law = lm.observers.kalman(plant, dt=DT)
    results = {
        "kalman": judged(*of_fixed_gain(law, given, *physical_noises(plant), eigenmode_share=0.0), true, rows)
    }
    for make in FILTERS:
        known = make(
            plant,
            dt=DT,
            sensor_noise={"speed_motor": SENSOR},
            process_torque=PROCESS_TORQUE,
            eigenmode_share=0.0,
        )
        estimate = known.run(given)
        results[make.__name__] = judged(estimate, estimate, true, rows)
    return results


def on_the_rig(work: str, seed: int) -> dict[str, list[tuple[float, float]]]:
    data = experiment(next(c for c in CASES if c.name == work), seed, DURATION)
    given = data.recording.only("torque_motor", "speed_motor")
    found = lm.observers.covariances(given, data.drivetrain, speed_from_counts=True)
    law = lm.observers.kalman(data.drivetrain, dt=DT, speed_from_counts=True)
    noises = {
        "kalman, 0.02 Nm·√s and 0.03 rad/s": physical_noises(data.drivetrain),
        "kalman, covariances from data": (found.process, found.measurement),
    }
    results = {
        name: judged(*of_fixed_gain(law, given, *noise), data.truth, data.judged)
        for name, noise in noises.items()
    }
    for make in FILTERS:
        estimate = make(data.drivetrain, dt=DT, speed_from_counts=True).run(given)
        results[make.__name__] = judged(estimate, estimate, data.truth, data.judged)
    return results


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    seeds = range(1, parser.parse_args().seeds + 1)
    rig = ((f"virtual rig, {work}", partial(on_the_rig, work)) for work in WORK)
    for place, job in (("the model as plant", on_the_model), *rig):
        with ProcessPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(job, seeds))
        print(
            f"\n| {place}: within two standard deviations, its ratio to the error | load speed | shaft torque |"
        )
        print("| --- | --- | --- |")
        for name in results[0]:
            middle = np.median([r[name] for r in results], axis=0)
            print(
                f"| {name} | "
                + " | ".join(f"{100 * share:.0f} %, {ratio:.2g}" for share, ratio in middle)
                + " |"
            )


if __name__ == "__main__":
    main()

"""Fig. 12 and 13 of Fietzek & Rinderknecht, and errors with their deviations: python docs/make_observer_pictures.py"""

from __future__ import annotations

from pathlib import Path

import lostmotion as lm
from lostmotion.compare import CASES
from lostmotion.compare.experiment import experiment
from lostmotion.observers.filters.tuning import PROCESS_TORQUE, SENSOR_NOISE

IMAGES = Path(__file__).parent / "images"
DT, STEP = 1e-4, 1.0
SPAN = (1.0, 1.2)
OBSERVERS = {
    "figure-12-observer-1": ("Observer 1", ("speed_motor",)),
    "figure-13-observer-2": ("Observer 2", ("torque_shaft", "speed_motor")),
}


def steps() -> None:
    """Parameters identified from one recording of rig 1, then the step from −2 to 2 rad/s under PI control."""
    recording, _ = lm.rig.record(1)
    nameplate = lm.Drivetrain.two_mass(
        inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
        viscous=0.0175,
    )  # fmt: skip
    found = lm.identify(recording, start=nameplate).drivetrain
    reference = lm.signals.steps((STEP,), (-2.0, 2.0), 1.5, DT)
    law = lm.controllers.pi(dt=DT, torque_limit=lm.rig.TORQUE_LIMIT)
    step, _ = lm.rig.record(1, law=law, speed_reference=reference, dt=DT, noise_seed=2)
    for file, (name, measured) in OBSERVERS.items():
        observer = lm.observers.kalman(found, measured=measured, dt=DT, speed_from_counts=True)
        figure = lm.plot.observer_step(
            step, observer.run(step), step_time=STEP, name=name, source="virtual rig (simulated)"
        )
        figure.savefig(IMAGES / f"{file}.png", dpi=100, facecolor="white")
        around, estimate = (r.window(STEP - 0.05, STEP + 0.1) for r in (step, observer.run(step)))
        for signal in ("speed_load", "twist"):
            error = lm.metrics.rmse(estimate[f"{signal}_estimated"], around[signal])
            print(
                f"{name}, {signal}: {100.0 * error / lm.metrics.signal_range(around[signal]):.2f} % of its range"
            )


def standard_deviations() -> None:
    """Observer 1, given 0.02 Nm·√s on both inertias, and the extended filter by its default, on rig 1."""
    data = experiment(next(case for case in CASES if case.name == "nominal"), 1, 1.5)
    plant, given = data.drivetrain, data.recording.only("torque_motor", "speed_motor")
    observer = lm.observers.kalman(plant, dt=DT, speed_from_counts=True)
    deviations = lm.observers.standard_deviations(
        observer, given,
        process_covariance={
            "speed_motor": (PROCESS_TORQUE["motor"] / plant.inertia_motor) ** 2,
            "speed_load": (PROCESS_TORQUE["load"] / plant.inertia_load) ** 2,
        },
        measurement_covariance={"speed_motor": SENSOR_NOISE["speed_motor"] ** 2 * DT},
    )  # fmt: skip
    estimate = observer.run(given)
    first = deviations.with_signals("estimated", **{name: estimate[name] for name in estimate})
    second = lm.observers.extended_kalman(plant, dt=DT, speed_from_counts=True).run(given)
    for name, signal in (
        ("standard-deviations", "speed_load"),
        ("standard-deviations-torque", "torque_shaft"),
    ):
        exact = given.with_signals("simulated", **{signal: data.truth[signal]})
        figure = lm.plot.estimate_errors(
            {"Observer 1": first, "extended Kalman": second}, exact, signal=signal, gap=data.truth["gap"] > 0.5,
            span=SPAN,
        )  # fmt: skip
        figure.savefig(IMAGES / f"{name}.png", dpi=100, facecolor="white")


def main() -> None:
    steps()
    standard_deviations()


if __name__ == "__main__":
    main()

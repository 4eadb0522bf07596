"""Fig. 12 and 13 of Fietzek & Rinderknecht from the virtual rig: python docs/make_observer_pictures.py"""

from __future__ import annotations

from pathlib import Path

import lostmotion as lm

IMAGES = Path(__file__).parent / "images"
DT, STEP = 1e-4, 1.0
OBSERVERS = {
    "figure-12-observer-1": ("Observer 1", ("speed_motor",)),
    "figure-13-observer-2": ("Observer 2", ("torque_shaft", "speed_motor")),
}


def main() -> None:
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
        observer = lm.observers.kalman(found, measured=measured, dt=DT, count_averaged=True)
        figure = lm.plot.observer_step(
            step, observer.run(step), step_time=STEP, name=name, source="virtual rig (simulated)"
        )
        figure.savefig(IMAGES / f"{file}.png", dpi=100, facecolor="white")


if __name__ == "__main__":
    main()

"""Makes the pictures of limit cycles: python docs/make_stability_pictures.py (some minutes)"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion import plot
from lostmotion.certificates import limit_cycle_map

IMAGES = Path(__file__).parent / "images"
DT = 1e-4
PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175,
)  # fmt: skip
#: Speed up to which the compensation rises, rad/s.
WIDTH = 0.5


def compensated(share: float, extra: float) -> tuple[lm.Drivetrain, lm.DiscreteSystem, float]:
    """PI with a share of the Coulomb torque added by the measured speed; Stribeck friction that falls to 0.1 rad/s."""
    friction = lm.Friction(2.0, 0.0175, stribeck=((0.0, extra), (0.1, 0.0)) if extra else ())
    law = lm.controllers.pi(dt=DT)
    if share:
        curve = lm.curves.saturation(2.0 * share, slope=2.0 * share / WIDTH)
        added = lm.DiscreteSystem(
            inputs=("torque_pi", "speed_motor"), outputs=("torque_motor",), dt=DT, curves=(curve,), G=[[0.0, 1.0]],
            J=np.ones((1, 1)), D=[[1.0, 0.0]],
        )  # fmt: skip
        parts = [law.renamed({"torque_motor": "torque_pi"}), added]
        law = lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))
    return replace(PLANT, frictions=(PLANT.frictions[0], friction)), law, 0.02


def with_gain(backlash: float, kp: float) -> tuple[lm.Drivetrain, lm.DiscreteSystem, float]:
    """PI with that gain, integral time 50 ms, torque limit of the paper."""
    law = lm.controllers.pi(dt=DT, kp=kp, ki=kp / 0.05, torque_limit=73.5)
    return PLANT.with_parameters(backlash=1e-3 * backlash), law, 0.5


def main() -> None:
    found = limit_cycle_map(
        compensated, ("friction compensation, share of the Coulomb torque", ""), np.linspace(0.0, 3.0, 7),
        ("Stribeck torque above Coulomb", "Nm"), (0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0), settle=8.0,
    )  # fmt: skip
    figure = plot.limit_cycle_map(found, title="PI at 0.02 rad/s: limit cycles, Hz (simulated)")
    figure.savefig(IMAGES / "limit-cycles-friction.png", dpi=110, facecolor="white")
    found = limit_cycle_map(
        with_gain, ("backlash", "mrad"), (0.0, 1.0, 3.0, 6.0, 12.0, 24.0),
        ("gain of the PI law", "Nm s/rad"), (10.0, 20.0, 25.0, 30.0, 40.0, 60.0), delay=10, settle=4.0,
    )  # fmt: skip
    figure = plot.limit_cycle_map(
        found, title="PI with 1 ms of delay at 0.5 rad/s: limit cycles, Hz (simulated)"
    )
    figure.savefig(IMAGES / "limit-cycles-backlash.png", dpi=110, facecolor="white")


if __name__ == "__main__":
    main()

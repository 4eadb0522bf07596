"""Makes the pictures of friction and locked-load backlash on the virtual rig: python docs/make_friction_pictures.py"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion import plot
from lostmotion.identification import friction_ladder, locked_backlash, torque_step

IMAGES = Path(__file__).parent / "images"
DT = 1e-3


def step() -> None:
    """Figure 5 of the paper, on the nominal rig: 12 Nm, then coasting."""
    torque = np.concatenate([np.zeros(500), np.full(9500, 12.0), np.zeros(4000)])
    recording, _ = lm.rig.record(None, torque_motor=torque, dt=DT)
    found = torque_step(recording, inertia=0.1292)
    figure = plot.friction_fit(
        found.time,
        found.torque,
        found.measured,
        found.fitted,
        source="simulated",
        title=f"Torque step on the virtual rig: Coulomb {found.values['coulomb']:.3f} Nm, "
        f"viscous {found.values['viscous']:.5f} Nm s/rad",
    )
    figure.savefig(IMAGES / "figure-5-torque-step.png", dpi=110, facecolor="white")


def ladder() -> None:
    speeds = [0.05, 0.2, 0.4, 0.7, 1.0, 1.5, 2.5, 5.0, 10.0, 20.0, 40.0]
    reference = np.repeat([s * w for s in (1.0, -1.0) for w in speeds], 2000)
    law = lm.controllers.pi(dt=DT, kp=1.0, ki=5.0)
    recording, _ = lm.rig.record(None, law=law, speed_reference=reference, dt=DT)
    found = friction_ladder(recording, inertia=0.1292)
    figure = plot.friction_curve(found.speed, found.torque, found.margin, found.steady, found.curve)
    figure.savefig(IMAGES / "friction-over-speed.png", dpi=110, facecolor="white")


def locked(bits: int) -> None:
    """Brakes closed: friction that nothing overcomes at the hub, 0.3 Nm of friction at the motor."""
    chain = lm.rig.nominal_rig().drivetrain
    frictions = (lm.Friction(0.3), *chain.frictions[1:-1], lm.Friction(1000.0))
    t = np.arange(12000) * DT
    torque = 15.0 * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * t / 4.0))
    run = lm.simulate(replace(chain, frictions=frictions), dt=DT, torque_motor=torque)
    count = 2.0 * np.pi / 2**bits
    angle = np.floor(run["angle_motor"] / count + 0.23) * count
    found = locked_backlash(lm.Recording(t, {"torque_motor": torque, "angle_motor": angle}))
    figure = plot.backlash_locked(
        found.torque,
        found.angle,
        found.side,
        found.fitted,
        backlash=found.values["backlash"],
        interval=found.intervals.get("backlash"),
        source="simulated",
    )
    figure.savefig(IMAGES / f"locked-load-{bits}-bit.png", dpi=110, facecolor="white")


def main() -> None:
    step()
    ladder()
    locked(16)
    locked(12)


if __name__ == "__main__":
    main()

"""A servo axis: motor, gearbox with backlash, long shaft, coupling with backlash, table with stiction.

    python examples/chain.py chain.png

Two backlashes at once, on either side of the gearbox, and a table that sticks: simulated exactly, from event to
event. An observer runs along in the loop: it sees the motor's encoder alone, takes the axis for two masses, and
estimates the speed of the table. The lower picture shows where the energy went.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import numpy as np

import lostmotion as lm
from lostmotion.drivetrain import Gear
from lostmotion.plot import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DT = 1e-4
#: Speed before the gearbox over speed behind it.
GEAR = Gear(5.0)


def axis() -> lm.Drivetrain:
    """The whole chain as the motor sees it. All numbers are chosen, of the size of a small machine tool's axis."""
    motor = lm.Drivetrain(
        inertias=(0.002, 0.0005),
        shafts=(lm.Shaft(stiffness=3000.0, damping=0.05),),
        frictions=(lm.Friction(coulomb=0.05, viscous=0.001), lm.Friction()),
        actuator=lm.Actuator(lag=3e-4, torque_limit=20.0),
    )
    # Behind the gearbox, in its own units: gear wheel, coupling hub, table.
    output = lm.Drivetrain(
        inertias=(0.01, 0.02, 0.25),
        shafts=(
            lm.Shaft(stiffness=20_000.0, damping=2.0),
            lm.Shaft(stiffness=40_000.0, damping=4.0, backlash=0.002, contact="physical"),
        ),
        frictions=(
            lm.Friction(viscous=0.02),
            lm.Friction(),
            lm.Friction(
                coulomb=4.0, viscous=0.5, breakaway=6.0, stribeck=((0.0, 2.0), (0.05, 0.5), (0.3, 0.0))
            ),
        ),
    )
    teeth = lm.Shaft(stiffness=60_000.0, damping=5.0, backlash=0.001, contact="clipped")
    return GEAR.join(motor, teeth, output)


def two_masses(chain: lm.Drivetrain) -> lm.Drivetrain:
    """The chain as an observer's model: rotor and wheel against all behind the teeth, gaps added up, one shaft."""
    table = chain.frictions[-1]
    return lm.Drivetrain.two_mass(
        inertia_motor=sum(chain.inertias[:2]),
        inertia_load=sum(chain.inertias[2:]),
        stiffness=1.0 / sum(1.0 / shaft.stiffness for shaft in chain.shafts),
        damping=0.02,
        backlash=sum(shaft.backlash for shaft in chain.shafts),
        coulomb=table.coulomb_plus,
        viscous=table.viscous,
        coulomb_motor=chain.frictions[0].coulomb_plus,
        viscous_motor=chain.frictions[0].viscous,
        lag=chain.actuator.lag,
        torque_limit=chain.actuator.torque_limit,
    )


def simulated() -> lm.Recording:
    """A slow torque that reverses: the table sticks, breaks away, and both gaps are crossed each time."""
    t = np.arange(10_000) * DT
    torque = 1.6 * np.sin(2.0 * np.pi * 2.0 * t)
    chain = axis()
    encoder = lm.Sensor("angle_motor", resolution=2.0 * np.pi / 2**18, difference=True)
    observer = lm.observers.super_twisting(two_masses(chain), dt=DT, speed_from_counts=True)
    return lm.simulate(
        chain, torque_motor=torque, dt=DT, law=observer, sensors={"speed_motor": encoder}, energy=True
    )


def picture(recording: lm.Recording) -> Figure:
    """Speeds with the table's sticking, both gaps with their impacts, and where the energy went."""
    figure, (speeds, gaps, energies) = style.panels(None, 3, size=(10.0, 9.0), sharex=True)
    t = recording.time
    speeds.plot(t, recording["speed_motor"] / GEAR.ratio, label="motor / 5", color="#999999", linewidth=0.8)
    speeds.plot(t, GEAR.behind("speed_load", recording["speed_load"]), label="table", **style.MEASURED)
    estimate = GEAR.behind("speed_load", recording["speed_load_estimated"])
    speeds.plot(t, estimate, label="table, estimated from the motor's encoder", **style.ESTIMATED)
    for event in recording.events:
        if event.place == "friction 5" and event.kind in ("stick", "slip"):
            dashes = (0, (1, 2)) if event.kind == "stick" else "-"
            speeds.axvline(event.time, color="#777777", linewidth=0.7, linestyle=dashes)
    speeds.set_ylim(top=1.5)
    speeds.set_ylabel("speed behind the gear (rad/s)")
    speeds.set_title("Table sticks (dotted) and breaks away (solid line)", fontweight="bold")
    for (number, name), line in zip(((2, "gear teeth"), (4, "coupling")), style.SERIES, strict=False):
        gaps.plot(t, 1e3 * GEAR.behind("twist", recording[f"twist_{number}"]), label=name, **line)
    impacts = recording.impacts(merge=2e-3)
    for event in impacts:
        gaps.axvline(event.time, color="#d9d9d9", linewidth=0.5, zorder=0)
    gaps.set_ylabel("twist behind the gear (mrad)")
    gaps.set_title(f"Both gaps; {len(impacts)} impacts, bounces within 2 ms merged", fontweight="bold")
    energy = recording.energy()
    for name, line in zip(("input", "stored", "dissipated"), style.SERIES, strict=False):
        energies.plot(t, energy[name], label=name, **line)
    energies.set_ylabel("energy (J)")
    energies.set_xlabel("time (s)")
    error = np.max(np.abs(energy["balance"]))
    energies.set_title(f"Energy; largest error of the balance {error:.0e} J", fontweight="bold")
    for axes in (speeds, gaps, energies):
        place = "upper left" if axes is energies else "upper right"
        axes.legend(loc=place, ncols=3 if axes is speeds else 1, frameon=False)
    figure.align_ylabels()
    return figure


def main() -> None:
    picture(simulated()).savefig(
        sys.argv[1] if len(sys.argv) > 1 else "chain.png", dpi=100, facecolor="white"
    )


if __name__ == "__main__":
    main()

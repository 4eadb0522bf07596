"""The drawings of docs/drawings.md: python docs/make_drawings.py"""

from __future__ import annotations

from pathlib import Path

import lostmotion as lm
from lostmotion.structure import paper_powertrain, reduce_to_chain

IMAGES = Path(__file__).parent / "images"
DT = 1e-4
#: Table I and the contact law of Fietzek & Rinderknecht.
PAPER = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175, contact="dead_zone",
)  # fmt: skip


def main() -> None:
    powertrain = paper_powertrain()
    reduced = reduce_to_chain(powertrain, 2, gap="joint")
    observer = lm.observers.kalman(PAPER, dt=DT)
    controller = lm.controllers.pole_placement(PAPER, dt=DT, torque_limit=lm.rig.TORQUE_LIMIT)
    figures = {
        "chain": lm.plot.chain(PAPER),
        "reduction": lm.plot.reduction(powertrain, reduced.drivetrain, gap="joint"),
        "observer": lm.plot.block_diagram(observer, title="Observer 1"),
        "loop": lm.plot.block_diagram([observer, controller], plant=PAPER),
    }
    for name, figure in figures.items():
        figure.savefig(IMAGES / f"drawing-{name}.png", dpi=110, facecolor="white")


if __name__ == "__main__":
    main()

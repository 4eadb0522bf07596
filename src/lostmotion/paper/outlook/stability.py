"""Is the nonlinear closed loop stable, and for which parameters?"""

from __future__ import annotations

import math

from ...certificates import BoxProof, around, headline, prove_box, prove_running
from ...controllers import pole_placement
from ...observers import kalman
from ...systems import DiscreteSystem, connect
from .. import published
from .answer import Answer

#: Half-width of the box of parameters, as a share, and the load speed from which it is proved, rad/s (option: one
#: cell, ten seconds of processor time).
HALF_WIDTH, BOX_SPEED = 0.1, 1.0


def stability(quick: bool) -> Answer:
    """The proof with the torque limit on Table I, and, unless quick, the one for a box around it without."""
    plant = published.paper_drivetrain()
    proof = prove_running(plant, proved_law(published.TORQUE_LIMIT))
    box = None if quick else prove_box(plant, proved_law(), around(HALF_WIDTH), speed=BOX_SPEED)
    return Answer(
        question="The stability of this nonlinear system has yet to be theoretically proved.",
        text=f"{headline(proof)} This is Observer 1 with pole placement at {1e3 * published.DT:g} ms, the "
        f"torque limit of {published.TORQUE_LIMIT:g} Nm, on Table I; every inequality is checked in exact "
        f"fractions. {_said(box)} Nothing is proved at standstill: all of the gap, and all that friction "
        "holds, are equilibria.",
        page="stability.md",
        numbers={
            "proved from load speed, rad/s": proof.speed,
            "proved up to load speed, rad/s": proof.fastest,
            "proved for steps up to, rad/s": proof.step,
            "half-width of the box that is proved, %": 100.0 * HALF_WIDTH
            if box is not None and box.proved
            else None,
        },
    )


def _said(box: BoxProof | None) -> str:
    """What is proved of the box, in a sentence."""
    if box is None:
        return "A box of parameters around it is proved by the run that is not quick."
    names = ", ".join(published.WORDS[name] for name in box.box)
    where = f"with {names} each anywhere within ±{100 * HALF_WIDTH:g} %"
    if not box.proved:
        return f"It is not proved {where}: {box.reason}."
    return f"Without the torque limit it is proved {where}, from {box.speed:g} rad/s on."


def proved_law(torque_limit: float = math.inf) -> DiscreteSystem:
    """Of Fig. 14; it reads the speed itself, not a mean over the sample, for which the proof holds."""
    plant = published.paper_drivetrain()
    control = pole_placement(
        plant, poles=(published.POLE_PLACED,) * 3, dt=published.DT, torque_limit=torque_limit
    )
    parts = [kalman(plant, dt=published.DT), control]
    return connect(parts, inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))

"""Is the nonlinear closed loop stable?"""

from __future__ import annotations

from ...certificates import headline, prove_running
from ...controllers import pole_placement
from ...observers import kalman
from ...systems import DiscreteSystem, connect
from .. import published
from .answer import Answer


def stability() -> Answer:
    """The proof for Observer 1 and pole placement with the torque limit, on Table I."""
    plant = published.paper_drivetrain()
    proof = prove_running(plant, proved_law())
    where = f"from {proof.speed:g} rad/s on" if proof.speed is not None else "nowhere"
    return Answer(
        question="The stability of this nonlinear system has yet to be theoretically proved.",
        text=f"It is proved {where}, for Observer 1 with pole placement at 0.1 ms, the torque limit of "
        f"{published.TORQUE_LIMIT:g} Nm, the "
        f"whole gap and set-valued friction, on Table I. {headline(proof)} Every inequality is checked in exact "
        "fractions. Below "
        "that speed there is no single rest: at standstill all of the gap and all that friction holds are equilibria.",
        page="stability.md",
        numbers={
            "proved from load speed, rad/s": proof.speed,
            "proved up to load speed, rad/s": proof.fastest,
            "proved for steps up to, rad/s": proof.step,
        },
    )


def proved_law() -> DiscreteSystem:
    """Of Fig. 14; it reads the speed itself, not a mean over the sample, for which the proof holds."""
    plant = published.paper_drivetrain()
    control = pole_placement(
        plant, poles=(published.POLE_PLACED,) * 3, dt=published.DT, torque_limit=published.TORQUE_LIMIT
    )
    parts = [kalman(plant, dt=published.DT), control]
    return connect(parts, inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))

"""Where the proof of a box stops: does the loop fail there too? The exact simulation says."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...simulation import simulate
from ...systems import DiscreteSystem
from ..equilibrium import equilibrium
from ..lure import lure_loop
from .box_proof import BoxProof
from .cell import scaled

#: Starts that are simulated, and for how long, s, beside the time that the gap takes at that speed, twice (option: the
#: paper's loops settle within 0.3 s).
STARTS, DURATION = 10, 1.0

#: Deviation from the load speed at rest that counts as settled, as a share of it (option).
SETTLED = 0.02


@dataclass(frozen=True)
class Simulated:
    """Of ``starts`` simulations of a drivetrain, ``settled`` ended at rest."""

    starts: int
    settled: int

    def __str__(self) -> str:
        who = "the proof stops, not the loop" if self.settled == self.starts else "the loop itself fails"
        return f"simulated there, {self.settled} of {self.starts} starts settle: {who}"


@checks_arguments
def simulated(
    drivetrain: Drivetrain, law: DiscreteSystem, proof: BoxProof, seed: int = 1
) -> Simulated | None:
    """The exact simulation where a proof stops, from random starts; None where it stops nowhere.

    Parameters
    ----------
    drivetrain, law
        Those of the proof.
    proof : BoxProof
    seed : int
        Of the starts: twist to twice, speeds to five times what they are at rest.
    """
    if proof.stops_at is None:
        return None
    plant, torque = scaled(drivetrain, proof.stops_at), proof.torque_load[0]
    rest = equilibrium(lure_loop(plant, law, delay=proof.delay), Fraction(proof.speed), Fraction(torque))
    if rest is None:
        return Simulated(STARTS, 0)
    duration = DURATION + 2.0 * plant.backlash / proof.speed
    rng, samples, settled = np.random.default_rng(seed), round(duration / law.dt), 0
    twist, reference = float(rest.state[0]), np.full(samples, float(rest.reference))
    for _ in range(STARTS):
        start = rng.uniform(-1.0, 1.0, 3) * (2.0 * twist, 5.0 * proof.speed, 5.0 * proof.speed)
        run = simulate(
            plant, law=law.without_checks(), dt=law.dt, delay=proof.delay, state=start.tolist(),
            speed_reference=reference, torque_load=np.full(samples, torque),
        )  # fmt: skip
        last = run["speed_load"][-samples // 20 :]
        settled += bool(np.max(np.abs(last - proof.speed)) < SETTLED * proof.speed)
    return Simulated(STARTS, settled)

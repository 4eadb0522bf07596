"""The truth that an identification of a drive of the zoo is judged by; fixed before anything was fitted (2026-11-22).

Changed 2026-11-23: the total inertia is judged of every drive; of a rigid one it was, under the name of the motor's.

A chain's equivalent two masses are those of ``rig.equivalent``: inertias are sums on each side of the gap, stiffness
follows from the first mode with those sums. Beyond that:

- **two gaps**: the backlash is the sum of both. The inertia between them belongs to neither side, so the two inertias
  have no equivalent, nor have stiffness and damping;
- **soft clutch**, a second shaft with half the compliance of the softest or more: there is no one shaft, so the two
  inertias, stiffness and damping have no equivalent; the backlash has;
- **friction**: Coulomb and viscous of motor and load each by the line closest to the curve at the recorded speeds, the
  Coulomb torque as the mean of both directions. Where an end never moves, there is none;
- **lag**: the sum of lag and delay. Of a recording of the measured torque there is none;
- **total inertia**: the sum of the whole chain, whatever else has no equivalent;
- **rigid**: there is no motor inertia apart from the total. There is no load inertia, no stiffness, no damping and no
  backlash, and nothing may be identified there.

What has no equivalent is None, and is not judged.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain, Friction
from ...recording import Recording
from ..equivalent import friction_line, two_mass_equivalent

#: What a rigid drive does not have.
ABSENT_IF_RIGID = ("inertia_load", "stiffness", "damping", "backlash")
#: From this compliance on, over that of the softest shaft, a further shaft is a soft clutch (option).
SOFT = 0.5


def equivalent(chain: Drivetrain, exact: Recording | None, delay: float) -> dict[str, float | None]:
    """Judged parameters of a chain, SI; without a recording, friction is None. ``delay`` in s."""
    whole = {"inertia_total": chain.inertia_total, "lag": chain.actuator.lag + delay}
    motor = _line(chain.frictions[0], exact, "speed_motor")
    if len(chain.inertias) == 1:
        # Of one inertia there is one friction, which may be reported as either end's.
        friction = dict(zip(("coulomb", "viscous"), motor, strict=True))
        told = {"inertia_motor": None, **dict.fromkeys(ABSENT_IF_RIGID, 0.0)}
        return {**told, **friction, "coulomb_motor": None, "viscous_motor": None, **whole}
    load = _line(chain.frictions[-1], exact, "speed_load")
    names = ("coulomb", "viscous", "coulomb_motor", "viscous_motor")
    friction = dict(zip(names, (*load, *motor), strict=True))
    found = chain_sums(chain) | friction | whole
    if sum(s.has_backlash for s in chain.shafts) > 1 or has_soft_clutch(chain):
        found |= dict.fromkeys(("inertia_motor", "inertia_load", "stiffness", "damping"))
    return found


def chain_sums(chain: Drivetrain) -> dict[str, float | None]:
    """Two masses by the sums on each side of the largest gap, whether or not they are an equivalent."""
    gaps = [s.backlash for s in chain.shafts if s.has_backlash]
    largest = max(gaps, default=0.0)
    one_gap = tuple(s if s.backlash == largest else replace(s, backlash=0.0) for s in chain.shafts)
    return two_mass_equivalent(replace(chain, shafts=one_gap), np.empty(0)) | {"backlash": sum(gaps)}


def has_soft_clutch(chain: Drivetrain) -> bool:
    compliances = sorted(1.0 / s.stiffness for s in chain.shafts)
    return len(compliances) > 1 and compliances[-2] >= SOFT * compliances[-1] * (1.0 + 1e-9)


def _line(friction: Friction, exact: Recording | None, signal: str) -> tuple[float | None, float | None]:
    """Coulomb and viscous friction of one end."""
    speed: NDArray[np.float64] = np.empty(0) if exact is None else exact[signal]
    mean = 0.5 * (friction.coulomb_plus + friction.coulomb_minus)
    return friction_line(replace(friction, coulomb=mean, breakaway=None), speed)

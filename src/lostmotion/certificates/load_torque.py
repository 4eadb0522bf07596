"""The smallest load torque against the motion with which a loop is proved that is not proved without one."""

from __future__ import annotations

import math
from typing import Any

from ..drivetrain import Drivetrain
from ..systems import DiscreteSystem
from .running import RunningProof, prove_running

#: Load torques that are tried, as shares of the largest (option).
SHARES = (0.1, 0.3, 0.5, 0.7)

#: A proof from this load speed on, rad/s, is good enough to try no larger load torque (option).
SLOW = 5.0

#: Largest load torque of such a proof, as a share of the torque limit (option: the rest is left to the control).
LARGEST = 0.5


def prove_with_load(drivetrain: Drivetrain, law: DiscreteSystem, **options: Any) -> RunningProof:
    """The proof without load torque; where there is none, with a constant one that resists the motion, a small one first.

    The shaft is then wound up further at rest, and the gap's sector is smaller (docs/stability.md, section "What is
    known of curves"). Arguments as for ``prove_running``, without ``torque_load``.
    """
    proof = prove_running(drivetrain, law, **options)
    if proof.speed is not None or not drivetrain.shaft.has_backlash:
        return proof
    limit = drivetrain.actuator.torque_limit
    bounded = min((max(abs(w) for _, w in curve.points) for curve in _limits(law)), default=math.inf)
    largest = LARGEST * min(limit, bounded)
    if not math.isfinite(largest):
        largest = drivetrain.stiffness * drivetrain.backlash
    for share in SHARES:
        loaded = prove_running(drivetrain, law, torque_load=(-largest, -share * largest), **options)
        if loaded.speed is not None and (proof.speed is None or loaded.speed < proof.speed):
            proof = loaded
        if proof.speed is not None and proof.speed <= SLOW:
            break
    return proof


def _limits(law: DiscreteSystem) -> list[Any]:
    """The curves of the law that bound its torque directly."""
    row = law.J[law.outputs.index("torque_motor")]
    used = [law.curves[i] for i in range(len(law.curves)) if row[i]]
    return [curve for curve in used if curve.slope_left == curve.slope_right == 0.0]

"""The proof with a load torque against the motion, for a loop that is not proved without one."""

from __future__ import annotations

import math
from typing import Any

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..systems import DiscreteSystem
from .running import RunningProof, prove_running

#: Smallest and largest load torque of such a proof, as shares of the torque limit (option: the law that a run designs
#: is proved with it on the virtual rig; the rest of the limit is left to the control).
SMALLEST, LARGEST = 0.15, 0.4


@checks_arguments
def prove_with_load(drivetrain: Drivetrain, law: DiscreteSystem, **options: Any) -> RunningProof:
    """The proof without load torque; where there is none, with a constant one that resists the motion.

    The shaft is then wound up further at rest, and the gap's sector is smaller (docs/proofs.md, equation 7).
    Arguments as for ``prove_running``, without ``torque_load``.
    """
    proof = prove_running(drivetrain, law, **options)
    if proof.speed is not None or not drivetrain.shaft.has_backlash:
        return proof
    largest = _torque_limit(drivetrain, law)
    return prove_running(drivetrain, law, torque_load=(-LARGEST * largest, -SMALLEST * largest), **options)


def _torque_limit(drivetrain: Drivetrain, law: DiscreteSystem) -> float:
    """The smaller limit of drive and law, Nm; without any, the torque that winds the shaft up by its backlash."""
    limits = [drivetrain.actuator.torque_limit]
    row = law.J[law.outputs.index("torque_motor")]
    for curve, used in zip(law.curves, row, strict=True):
        if used and curve.slope_left == curve.slope_right == 0.0:
            limits.append(max(abs(w) for _, w in curve.points))
    smallest = min(limits)
    return smallest if math.isfinite(smallest) else drivetrain.stiffness * drivetrain.backlash

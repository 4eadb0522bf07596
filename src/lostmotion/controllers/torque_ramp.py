"""Ramp of a torque that is asked for: slow while the shaft unwinds, fast while it winds up."""

from __future__ import annotations

import math

import numpy as np

from ..argument_checks import checks_arguments
from ..curves import PiecewiseLinear
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from ..systems.checks import sample_time
from ..systems.limits import POSITIVE_PART


@checks_arguments
def torque_ramp(*, unwinding_rate: float, winding_rate: float, dt: float) -> DiscreteSystem:
    """``torque_ramp`` follows ``torque_reference`` by at most so much per second.

    ::

        torque_ramp⁺ = clip(torque_reference, torque_ramp − rate₋·dt, torque_ramp + rate₊·dt)

    rate₊ is ``winding_rate`` where torque_ramp is positive and ``unwinding_rate`` where it is negative, rate₋ the other
    way round, with a straight line between them over unwinding_rate·dt. A torque that falls unwinds the shaft, and the
    load feels it at once. A torque that rises meets the gap first, where soft landing holds it back; a slow ramp there
    only makes the gap last longer.

    Parameters
    ----------
    unwinding_rate, winding_rate : float, Nm/s
        Towards zero, and away from it.
    dt : float, s

    Returns
    -------
    DiscreteSystem
        Input torque_reference; output torque_ramp; state torque_ramp_last.

    Raises
    ------
    InvalidInput
        If a rate is not positive, or the torque may rise more slowly than it falls.
    """
    dt = sample_time("torque_ramp.dt", dt)
    if not 0.0 < unwinding_rate <= winding_rate < math.inf:
        raise InvalidInput(
            "torque_ramp", f"rates {unwinding_rate!r} and {winding_rate!r} Nm/s", "0 < unwinding_rate ≤ winding_rate",
            "Give both in Nm/s.",
        )  # fmt: skip
    slow, fast = dt * unwinding_rate, dt * winding_rate
    most = PiecewiseLinear(((0.0, slow), (slow, fast)))
    # Curves: largest rise and fall, what the set-point is above the one, what the result is below the other.
    by_curves = np.zeros((4, 4))
    by_curves[2, 0] = -1.0
    by_curves[3, [1, 2]] = -1.0, 1.0
    clipped = np.array([[0.0, 0.0, -1.0, 1.0]])
    return DiscreteSystem(
        inputs=("torque_reference",), outputs=("torque_ramp",), states=("torque_ramp_last",), dt=dt, name="torque_ramp",
        curves=(most, most, POSITIVE_PART, POSITIVE_PART), F=np.array([[1.0], [-1.0], [-1.0], [1.0]]),
        G=np.array([[0.0], [0.0], [1.0], [-1.0]]), H=by_curves, D=np.eye(1), J=clipped,
        A=np.zeros((1, 1)), B=np.eye(1), E=clipped,
    )  # fmt: skip

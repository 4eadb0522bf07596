"""A torque by the direction of the set-point: compensation of Coulomb friction that cannot chatter."""

from __future__ import annotations

from ..curves import PiecewiseLinear

#: Speed set-point (rad/s) from which on the compensation by its direction is full; linear below (chosen).
REFERENCE_BAND = 0.1


def reference_direction(plus: float, minus: float) -> PiecewiseLinear:
    """−minus for negative set-points, plus for positive ones, zero at zero."""
    return PiecewiseLinear(((-REFERENCE_BAND, -minus), (0.0, 0.0), (REFERENCE_BAND, plus)))

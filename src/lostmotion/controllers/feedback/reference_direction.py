"""A torque by the direction of the set-point: compensation of Coulomb friction that cannot chatter."""

from __future__ import annotations

from ...curves import PiecewiseLinear

#: Speed set-point (rad/s) from which on the compensation by its direction is full; linear below (option:
#: the same for drives of every size).
REFERENCE_BAND = 0.1


def reference_direction(plus: float, minus: float, viscous: float = 0.0) -> PiecewiseLinear:
    """−minus for negative set-points, plus for positive ones (Nm), zero at zero; and viscous·set-point (Nm s/rad)."""
    band, extra = REFERENCE_BAND, viscous * REFERENCE_BAND
    return PiecewiseLinear(((-band, -minus - extra), (0.0, 0.0), (band, plus + extra)), viscous, viscous)

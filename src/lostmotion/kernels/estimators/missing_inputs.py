"""Missing inputs: the torque to use instead, and what is uncertain while it, or every sensor, is missing."""

from __future__ import annotations

from ..jit import njit
from .layout import SPEED_MOTOR, TWIST


@njit(cache=True, inline="always")
def torque_to_use(p, memory, torque, faults):
    """The motor torque to use and the faults: beyond the bound it is missing, and the last one is used."""
    if abs(torque) <= p.torque_bound:
        memory.torque = torque
    else:
        faults |= 1
    return memory.torque, faults


@njit(cache=True, inline="always")
def blind_samples(p, blind, faults):
    """For how many samples no sensor was there, at most ``hold``; then back as fast."""
    if faults >> 1 == (1 << int(p.sensors)) - 1:
        return min(blind + 1.0, p.hold)
    return max(blind - 1.0, 0.0)


@njit(cache=True, inline="always")
def add_missing_torque(p, P, missing, blind):
    """Process noise of a missing motor torque within a sample, added to the covariance.

    The motor's speed then follows its sensor. While there is none either, the unknown torque is a constant: the
    deviation grows with time, not with its root. After a time without sensors the joint may be on either side of the
    gap, and a filter that linearises the gap once settles on one of them too soon: so the twist drifts for as long
    again.
    """
    if missing:
        P[SPEED_MOTOR, SPEED_MOTOR] += (p.torque_missing * p.dt) ** 2 * max(blind, 1.0)
    elif blind > 0.0:
        P[TWIST, TWIST] += (p.side_unknown * p.dt) ** 2 * blind

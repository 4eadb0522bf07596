"""Coulomb friction that rises towards rest, over a sub-step in which the speed changes steadily, for the filter.

Level · (1 + rise · exp(−|speed| / fade)). Source: Bo, Pavelescu (1982), The friction–speed relation and its influence
on the critical velocity of stick–slip motion, Wear 82, 277–289, with exponent one.
"""

from __future__ import annotations

import math

from ..jit import njit
from .columns import INNER

#: Speeds over the fading speed that differ by less are one (numerics: the quotient's rounding).
_ONE = 1e-4


@njit(forceinline=True, **INNER)
def _mean_rise(first, last, rise, fade):
    """Mean of rise · exp(−|speed| / fade) while the speed goes from first to last, without turning."""
    if rise == 0.0:
        return 0.0
    near, far = abs(first) / fade, abs(last) / fade
    if abs(far - near) < _ONE:
        return rise * math.exp(-0.5 * (near + far))
    return rise * (math.exp(-near) - math.exp(-far)) / (far - near)


@njit(forceinline=True, **INNER)
def sliding_friction(before, free, per_torque, level, rise, fade):
    """``mean_friction`` of an inertia that slides all the while, and its change with the speed at the end that it would
    have without the rise."""
    slipping = level if before > 0.0 else -level
    if rise == 0.0:
        return slipping, 0.0
    end = free + slipping * per_torque
    if end * before <= 0.0:
        return slipping * (1.0 + _mean_rise(before, 0.0, rise, fade)), 0.0
    mean, near, far = _mean_rise(before, end, rise, fade), abs(before) / fade, abs(end) / fade
    if abs(far - near) < _ONE:
        return slipping * (1.0 + mean), -0.5 * level * mean / fade
    return slipping * (1.0 + mean), level * (rise * math.exp(-far) - mean) / ((far - near) * fade)


@njit(forceinline=True, **INNER)
def mean_friction(before, free, per_torque, level, rise, fade):
    """Mean torque of a friction over a sub-step, and whether its inertia is at rest in the end.

    ``before``: speed at the beginning; ``free``: at the end without this friction; ``per_torque``: what a friction of
    1 Nm adds. It acts against the motion until that ends, then holds if its level suffices.
    """
    slipping, moving = 0.0, 0.0
    if before != 0.0:
        slipping = level if before > 0.0 else -level
        end = free + slipping * per_torque
        slipping *= 1.0 + _mean_rise(before, end if end * before > 0.0 else 0.0, rise, fade)
        end = free + slipping * per_torque
        if end * before > 0.0:
            return slipping, False
        moving = before / (before - end)
    holding, most = (before - free) / per_torque, level * (1.0 + rise)
    limited = min(max(holding, -most), most)
    return moving * slipping + (1.0 - moving) * limited, limited == holding


@njit(forceinline=True, **INNER)
def friction_slope(first, last, level, rise, fade):
    """Change of the friction with the speed, Nm s/rad, between two speeds; 0 where it does not slide all the way."""
    if rise == 0.0 or first * last <= 0.0:
        return 0.0
    near, far = abs(first) / fade, abs(last) / fade
    if abs(far - near) < _ONE:
        return -level * rise / fade * math.exp(-0.5 * (near + far))
    return -level * rise / fade * (math.exp(-near) - math.exp(-far)) / (far - near)

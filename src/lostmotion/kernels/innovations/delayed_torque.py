"""The motor torque that acts over a sample, after a delay that is no whole number of samples."""

from __future__ import annotations

from ..jit import njit
from .columns import INNER
from .transitions import OFFSET, PART, WHOLE


@njit(forceinline=True, **INNER)
def delayed(torque, k, c, of, ramp):
    """Mean of the torque that acts over sample k, and by how much it is higher at the beginning than in the end."""
    first, last = k - int(c[of + WHOLE]), torque.size - 1
    now, before = torque[min(max(first, 0), last)], torque[min(max(first - 1, 0), last)]
    mean = now + c[of + PART] * (before - now) + c[of + OFFSET]
    if not ramp:
        return mean, before - now
    after = torque[min(max(first + 1, 0), last)]
    end = after + c[of + PART] * (now - after) + c[of + OFFSET]
    return 0.5 * (mean + end), mean - end


@njit(forceinline=True, **INNER)
def torque_at_ends(mean, jump, part, ramp):
    """Torque at the beginning and at the end of a sample, from its mean and what it is higher by at the beginning."""
    if ramp:
        return mean + 0.5 * jump, mean - 0.5 * jump
    # It is held, and changes after this part of the sample.
    return mean + ((1.0 - part) * jump if part > 0.0 else 0.0), mean - part * jump

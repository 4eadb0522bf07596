"""The gap where a filter does not know on which side of an edge it is: its mean over what is likely.

Statistical linearisation, Gelb (1974), Applied Optimal Estimation, chapter 6.
"""

from __future__ import annotations

import math

from ..jit import njit
from .columns import INNER
from .transitions import BLOCK

_ROOT_HALF, _DENSITY = math.sqrt(0.5), 1.0 / math.sqrt(2.0 * math.pi)


@njit(forceinline=True, **INNER)
def mean_gap(z, half, deviation):
    """For z spread by ``deviation``: chance of contact, the edge that the spring sees while it is in contact, and the
    variance of the spring's twist beyond what the chance makes of z's."""
    above, below = (z - half) / deviation, (-z - half) / deviation
    plus, minus = 0.5 * math.erfc(-above * _ROOT_HALF), 0.5 * math.erfc(-below * _ROOT_HALF)
    over, under = _DENSITY * math.exp(-0.5 * above * above), _DENSITY * math.exp(-0.5 * below * below)
    chance = plus + minus
    mean = over + above * plus - under - below * minus
    square = (1.0 + above * above) * plus + above * over + (1.0 + below * below) * minus + below * under
    # The blended spring has the chance already: the edge must not have it again.
    edge = (half * (plus - minus) - deviation * (over - under)) / max(chance, 1e-300)
    return chance, edge, deviation * deviation * max(square - mean * mean - chance * chance, 0.0)


@njit(forceinline=True, **INNER)
def blend(t, open, closed, weight, mixed):
    """Transition over a whole sample, open + weight·(closed − open); which begin at t[open], t[closed]."""
    for i in range(BLOCK):
        mixed[i] = t[open + i] + weight * (t[closed + i] - t[open + i])

"""An actuator whose torque changes by a limited rate."""

from __future__ import annotations

import numpy as np

from ..jit import njit
from .layout import COMPILED


@njit(**COMPILED)
def limit_rate(values, step, last):
    """Set-points that follow `values` by at most `step` from sample to sample, from `last` on."""
    limited = np.empty(values.size)
    for k in range(values.size):
        last = min(max(values[k], last - step), last + step)
        limited[k] = last
    return limited

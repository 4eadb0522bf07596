"""What a sensor shows of a true value: counts, differences of counts, noise. The one place that knows."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..jit import njit

#: No fastmath: a sensor shows the same bits in the loop and over a recording.
_COMPILED: Any = {"cache": True, "error_model": "numpy", "nogil": True}


@njit(forceinline=True, **_COMPILED)
def quantised(value, resolution):
    """Rounded down to whole steps; a resolution of 0 is none."""
    return np.floor(value / resolution) * resolution if resolution > 0.0 else value


@njit(forceinline=True, **_COMPILED)
def shown(value, before, difference, dt, disturbance):
    """A quantised value, or its difference to the sample before over dt (0 in the first sample, where that is NaN)."""
    if difference == 1:
        value = 0.0 if np.isnan(before) else (value - before) / dt
    return value + disturbance


@njit(**_COMPILED)
def over_a_recording(values, resolution, difference, dt, disturbance):
    """(n,) readings of (n,) true values; disturbance: (n,), or (1,) where it is the same in every sample."""
    readings = np.empty_like(values)
    before = np.nan
    for k in range(values.size):
        value = quantised(values[k], resolution)
        readings[k] = shown(value, before, difference, dt, disturbance[k if disturbance.size > 1 else 0])
        before = value
    return readings

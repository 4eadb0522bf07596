"""Super-twisting observer: one step."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .steppers import INIT, STEP
from .steppers_model import clip
from .steppers_speed_only import FREE, SIZE, correct, innovation_of, outputs_of

# Own parameters: gain on the root of the innovation and gain of the integral (both per sample), bound of the integral,
# innovation below which the sign is a line, corrections of twist and load speed per integral, inertia over sample time.
ROOT, INTEGRAL, BOUND, LAYER, TO_TWIST, TO_LOAD, INERTIA = (
    FREE, FREE + 1, FREE + 2, FREE + 3, FREE + 4, FREE + 5, FREE + 6,
)  # fmt: skip

#: Place of the integral in the state: correction of the motor speed per sample.
SUM = SIZE


@njit(INIT, cache=True)
def init(p):
    return np.zeros(SIZE + 1)


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    torque, innovation, faults = innovation_of(p, s, inputs, faults)
    outputs_of(p, s, outputs)
    outputs[6] = p[INERTIA] * s[SUM]
    if faults & 2:
        injection = 0.0
    else:
        sign = clip(innovation / p[LAYER], -1.0, 1.0)
        injection = p[ROOT] * math.sqrt(abs(innovation)) * sign + s[SUM]
        s[SUM] = clip(s[SUM] + p[INTEGRAL] * sign, -p[BOUND], p[BOUND])
    if correct(p, s, torque, p[TO_TWIST] * s[SUM], injection, p[TO_LOAD] * s[SUM]):
        s[SUM] = 0.0
    return faults

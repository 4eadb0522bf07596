"""Super-twisting observer: one step."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .motor_speed import FREE, SENSOR, SIZE, correct, innovation_of, outputs_of, predict
from .runner import INIT, STEP
from .two_mass_model import ANGLE, DT, clip

# Own parameters: gain on the root of the innovation and gain of the integral (both per sample), bound of the integral,
# innovation below which the sign is a line, corrections of twist and load speed per integral, inertia over sample time,
# correction of the angle per innovation.
ROOT, INTEGRAL, BOUND, LAYER, TO_TWIST, TO_LOAD, INERTIA, TO_ANGLE = (
    FREE, FREE + 1, FREE + 2, FREE + 3, FREE + 4, FREE + 5, FREE + 6, FREE + 7,
)  # fmt: skip

#: Places in the state: the integral, which is the correction of the motor speed per sample, and what it was before the
#: sensor's present value came.
SUM, KEPT = SIZE, SIZE + 1


@njit(INIT, cache=True)
def init(p):
    return np.zeros(SIZE + 2)


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    torque, innovation, faults = innovation_of(p, s, inputs, faults)
    if faults & 2:
        s[SUM] = s[KEPT]
    else:
        if s[SENSOR + 1] == 1.0:
            s[KEPT] = s[SUM]
        sign = clip(innovation / p[LAYER], -1.0, 1.0)
        injection = p[ROOT] * math.sqrt(abs(innovation)) * sign
        s[SUM] = clip(s[SUM] + p[INTEGRAL] * sign, -p[BOUND], p[BOUND])
        correct(p, s, p[TO_ANGLE] * innovation, p[TO_TWIST] * s[SUM], injection, p[TO_LOAD] * s[SUM])
    outputs_of(p, s, outputs)
    outputs[6] = p[INERTIA] * s[SUM]
    if faults & 2 == 0:
        s[1] += s[SUM]
        s[ANGLE] += 0.5 * p[DT] * s[SUM]
    if predict(p, s, torque):
        s[SUM] = s[KEPT] = 0.0
    return faults

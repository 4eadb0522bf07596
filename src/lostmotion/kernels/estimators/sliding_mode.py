"""Sliding-mode observer: one step."""

from __future__ import annotations

import numpy as np
from numba import njit

from .motor_speed import FREE, SIZE, correct, innovation_of, outputs_of, predict
from .runner import INIT, STEP
from .two_mass_model import clip

# Own parameters: reach (largest correction of the motor speed per sample), layer (innovation at which it is reached),
# corrections of twist and load speed per correction of the motor speed, correction of the angle per innovation.
REACH, LAYER, TO_TWIST, TO_LOAD, TO_ANGLE = FREE, FREE + 1, FREE + 2, FREE + 3, FREE + 4


@njit(INIT, cache=True)
def init(p):
    return np.zeros(SIZE)


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    torque, innovation, faults = innovation_of(p, s, inputs, faults)
    injection = p[REACH] * clip(innovation / p[LAYER], -1.0, 1.0)
    correct(p, s, p[TO_ANGLE] * innovation, p[TO_TWIST] * injection, injection, p[TO_LOAD] * injection)
    outputs_of(p, s, outputs)
    predict(p, s, torque)
    return faults

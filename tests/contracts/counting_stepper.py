"""The smallest stepper: counts samples, integrates its input, passes faults on."""

from __future__ import annotations

import numpy as np
from numba import njit

from lostmotion.kernels.estimators.runner import INIT, STEP


@njit(INIT)
def init(parameters):
    return np.zeros(2)


@njit(STEP)
def step(parameters, state, inputs, faults, outputs):
    outputs[0] = state[0]
    outputs[1] = state[1]
    state[0] += 1.0
    state[1] += parameters[0] * inputs[1]
    if inputs[0] > 100.0:
        faults |= 1
    return faults

"""Scheduled state feedback: one step. Its gains follow the load inertia that an observer tracks."""

from __future__ import annotations

import numpy as np

from .estimators.runner import INIT, STEP
from .jit import njit

#: Inputs with a gain, in their order; after them comes the load inertia. A gain more for the current loop's torque and
#: for the motor's friction (layout).
SIGNALS = 7
GAINS = SIGNALS + 2
#: Load inertias with gains of their own; each row of the table is an inertia and its gains (layout).
POINTS = 13
ROW = 1 + GAINS
#: Parameters (layout): torque limit, decay of the current loop's torque, largest change of the inertia in a sample (a
#: share of it), the one to start from, Coulomb friction of the motor and its band, the table.
LIMIT, DECAY, CHANGE, NOMINAL, COULOMB_PLUS, COULOMB_MINUS, BAND, TABLE = range(8)
PARAMETERS = TABLE + POINTS * ROW
#: State (layout): torque of the current loop (Nm), inertia that the gains are for (kg m²).
ACTUATOR, INERTIA, STATE = range(3)


@njit("float64(float64, float64, float64)", cache=True)
def between(value, low, high):
    """The value, or the bound that it is beyond."""
    return low if value < low else (high if value > high else value)


@njit(INIT, cache=True)
def init(parameters):
    state = np.zeros(STATE)
    state[INERTIA] = parameters[NOMINAL]
    return state


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    now = state[INERTIA]
    change = parameters[CHANGE] * now
    now = between(inputs[SIGNALS], now - change, now + change)
    now = between(now, parameters[TABLE], parameters[TABLE + (POINTS - 1) * ROW])
    state[INERTIA] = now
    low = TABLE
    while low < TABLE + (POINTS - 2) * ROW and parameters[low + ROW] < now:
        low += ROW
    high = low + ROW
    share = (now - parameters[low]) / (parameters[high] - parameters[low])
    torque = 0.0
    for i in range(GAINS):
        gain = parameters[low + 1 + i] + share * (parameters[high + 1 + i] - parameters[low + 1 + i])
        if i < SIGNALS:
            torque += gain * inputs[i]
        elif i == SIGNALS:
            torque += gain * state[ACTUATOR]
        else:
            direction = between(inputs[0] / parameters[BAND], -1.0, 1.0)
            level = parameters[COULOMB_PLUS] if direction > 0.0 else parameters[COULOMB_MINUS]
            torque += gain * level * direction
    outputs[0] = between(torque, -parameters[LIMIT], parameters[LIMIT])
    decay = parameters[DECAY]
    state[ACTUATOR] = decay * state[ACTUATOR] + (1.0 - decay) * inputs[5]
    return faults

"""Super-twisting observer: one step (Levant 1998, Automatica 34, 379–384)."""

from __future__ import annotations

import math

import numpy as np

from ...jit import njit
from ..layout import ANGLE_COUNTED, SPEED_MOTOR, TWISTING, TWISTING_PARAMETERS, size
from ..records import reads
from ..runner import INIT, STEP
from ..two_mass_model import clip
from .speed_observer import correct, innovation_of, predict, write

_parameters, _memory = reads(TWISTING_PARAMETERS), reads(TWISTING)
_SIZE = size(TWISTING)


@njit(INIT, cache=True)
def init(parameters):
    return np.zeros(_SIZE)


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    own, memory = _parameters(parameters), _memory(state)
    observer, s = own.common, memory.common
    p, x = observer.common, s.x
    torque, innovation, faults = innovation_of(observer, s, inputs, faults)
    if faults & 2:
        memory.integral = memory.integral_before
    else:
        if s.sensor.repeats == 1.0:
            memory.integral_before = memory.integral
        sign = clip(innovation / own.layer, -1.0, 1.0)
        injection = own.root * math.sqrt(abs(innovation)) * sign
        memory.integral = clip(memory.integral + own.integral * sign, -own.bound, own.bound)
        integral = memory.integral
        correct(
            observer, s, own.to_angle * innovation, own.to_twist * integral, injection, own.to_load * integral
        )
    write(observer, s, outputs)
    outputs[6] = own.inertia * memory.integral
    if faults & 2 == 0:
        x[SPEED_MOTOR] += memory.integral
        x[ANGLE_COUNTED] += 0.5 * p.dt * memory.integral
    if predict(observer, s, torque):
        memory.integral = memory.integral_before = 0.0
    return faults

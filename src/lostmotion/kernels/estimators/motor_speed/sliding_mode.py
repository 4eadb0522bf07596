"""Sliding-mode observer: one step."""

from __future__ import annotations

import numpy as np

from ...jit import njit
from ..layout import SLIDING_PARAMETERS, SPEED_OBSERVER, size
from ..records import reads
from ..runner import INIT, STEP
from ..two_mass_model import clip
from .speed_observer import correct, innovation_of, predict, write

_parameters, _memory = reads(SLIDING_PARAMETERS), reads(SPEED_OBSERVER)
_SIZE = size(SPEED_OBSERVER)


@njit(INIT, cache=True)
def init(parameters):
    return np.zeros(_SIZE)


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    own, s = _parameters(parameters), _memory(state)
    observer = own.common
    torque, innovation, faults = innovation_of(observer, s, inputs, faults)
    injection = own.reach * clip(innovation / own.layer, -1.0, 1.0)
    correct(
        observer, s, own.to_angle * innovation, own.to_twist * injection, injection, own.to_load * injection
    )
    write(observer, s, outputs)
    predict(observer, s, torque)
    return faults

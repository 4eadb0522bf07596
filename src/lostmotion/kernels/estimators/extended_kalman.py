"""Extended Kalman filter with parameters as states: one step (Särkkä 2013, algorithm 5.4)."""

from __future__ import annotations

import numpy as np

from ..jit import njit
from .contact import predict_contact
from .layout import MOVING, PARAMETERS, TRACKED, record
from .records import reads, scratch
from .runner import INIT, STEP
from .tracking.correction import measurement_update
from .tracking.prediction import predict
from .tracking.start import SIZE, before_first_sample, keep_before, memory_of, start_again_if_lost

_parameters = reads(PARAMETERS)
_scratch = scratch(
    record(("H", (TRACKED,)), ("PHt", (TRACKED,)), ("F", (MOVING, TRACKED)), ("FP", (MOVING, TRACKED)))
)


@njit(INIT, cache=True)
def init(parameters):
    state = np.zeros(SIZE)
    before_first_sample(_parameters(parameters), memory_of(state))
    return state


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    p, s, w = _parameters(parameters), memory_of(state), _scratch()
    torque, faults = measurement_update(p, s, inputs, faults, outputs, w.H, w.PHt)
    keep_before(s)
    predict_contact(p, s.estimate.x, s.estimate.P, s.contact)
    predict(p, s, torque, w.F, w.FP)
    start_again_if_lost(p, s)
    return faults

"""Interacting models — contact at the upper edge, gap, contact at the lower edge — with their probabilities: one step.

Blom & Bar-Shalom 1988, IEEE Trans. Automatic Control 33, 780–783: mix, predict each, correct each, weigh. Each model is
an extended Kalman filter with the gap term of its own side.
"""

from __future__ import annotations

import numpy as np

from ...jit import njit
from ..layout import INTERACTING, MODEL_STATES, MODELS, MOVING, estimate, record, size
from ..missing_inputs import add_missing_torque, blind_samples, torque_to_use
from ..records import scratch
from ..runner import INIT, STEP
from ..sensors import OF_SPEED_MOTOR
from .correction import correct_by_sensor, write
from .mixing import PARTS, mix
from .prediction import predict
from .state import memory_of, parameters_of, restart, start_again_if_lost

_SIZE = size(INTERACTING)
_scratch = scratch(
    record(
        ("H", (MODEL_STATES,)), ("PHt", (MODELS, MODEL_STATES)), ("nu", (MODELS,)), ("S", (MODELS,)),
        ("mean", (MODEL_STATES,)), ("variance", (MODEL_STATES,)),
        ("mixed", estimate(MODEL_STATES), MODELS), ("parts", PARTS, MODELS),
        ("F", (MOVING, MODEL_STATES)), ("FP", (MOVING, MODEL_STATES)),
    )
)  # fmt: skip


@njit(INIT, cache=True)
def init(parameters):
    state = np.zeros(_SIZE)
    s = memory_of(state)
    restart(parameters_of(parameters), s, 0.0, MODEL_STATES)
    s.started = 0.0
    return state


@njit(cache=True)
def _begin(own, s, inputs, faults):
    """The torque to use and the faults; a first sample starts all models."""
    p = own.common
    torque, faults = torque_to_use(p, s, inputs[0], faults)
    # While the torque is known, three models know the side well enough.
    s.blind = blind_samples(p, s.blind, faults if faults & 1 else 0)
    for m in range(MODELS):
        add_missing_torque(p, s.models[m].P, faults & 1 != 0, s.blind)
    if s.started == 0.0:
        known = int(p.kind[0]) == OF_SPEED_MOTOR and faults & 2 == 0
        restart(own, s, inputs[1] if known else 0.0, MODEL_STATES)
    return torque, faults


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    own, s, w = parameters_of(parameters), memory_of(state), _scratch()
    p = own.common
    torque, faults = _begin(own, s, inputs, faults)
    for i in range(int(p.sensors)):
        if correct_by_sensor(own, s, i, inputs[1 + i], faults & (2 << i) != 0, w):
            faults |= 2 << i
    start_again_if_lost(own, s)
    write(own, s, w.H, w.mean, w.variance, outputs)
    for _ in range(int(p.substeps)):
        mix(own, s, w.mixed, w.parts)
        s.friction = 0.0
        for m in range(MODELS):
            s.friction += s.probability[m] * predict(own, s.models[m], m, w.mixed[m], torque, w.F, w.FP)
    start_again_if_lost(own, s)
    return faults

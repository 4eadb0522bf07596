"""Moving-horizon estimator: one step."""

from __future__ import annotations

import numpy as np

from ...jit import njit
from ..layout import MOVING, TRACKED, TRACKED_ESTIMATE, record
from ..records import scratch
from ..runner import INIT, STEP
from ..tracking.outputs import write
from ..tracking.prediction import predict
from ..tracking.start import before_first_sample, begin, bound, keep_before
from .gauss_newton import count_at, forget_oldest, gauss_newton
from .horizon import (
    append,
    begin_horizon,
    copy_estimate,
    empty_if_lost,
    memory_of,
    memory_size,
    parameters_of,
)

_scratch = scratch(
    record(
        ("H", (TRACKED,)), ("PHt", (TRACKED,)), ("F", (MOVING, TRACKED)), ("FP", (MOVING, TRACKED)),
        ("slope", (MOVING, TRACKED)), ("x", (TRACKED,)), ("apart", (TRACKED,)), ("estimate", TRACKED_ESTIMATE),
    )
)  # fmt: skip


@njit(INIT, cache=True)
def init(parameters):
    own = parameters_of(parameters)
    state = np.zeros(memory_size(own))
    before_first_sample(own.common, memory_of(state).filter)
    return state


@njit(cache=True)
def _correct(own, h, inputs, torque, faults, w):
    """The newest estimate from the horizon with this sample; returns the faults and whether it starts again."""
    p = own.common
    if h.count >= own.nodes:
        forget_oldest(p, h, w)
    faults, again = append(p, h, inputs, torque, faults, w)
    if again:
        begin_horizon(h)
    else:
        h.count += 1.0
        for _ in range(int(own.passes)):
            gauss_newton(p, h, w)
        copy_estimate(w.estimate, h.filter.estimate)
        bound(p, h.filter.estimate.x)
    return faults, again


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    own, h, w = parameters_of(parameters), memory_of(state), _scratch()
    p, s = own.common, h.filter
    fresh = s.started == 0.0
    torque, faults = begin(p, s, inputs, faults)
    if fresh:
        begin_horizon(h)
    faults, again = _correct(own, h, inputs, torque, faults, w)
    empty_if_lost(own, state)
    write(p, s, w.H, w.PHt, outputs)
    keep_before(s)
    if h.count > 0.0:
        count_at(p, s, h.nodes[int(h.count) - 1], s.estimate)
    predict(p, s, torque, w.F, w.FP)
    if again:
        begin_horizon(h)
    empty_if_lost(own, state)
    return faults

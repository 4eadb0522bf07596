"""Intelligent observer: radial-basis networks that learn what friction and gap curve of the model miss: one step.

Total gap curve clip(z, ±half) + Σ gap weight·ψ(z), total friction = model + Σ friction weight·φ(speed_load), both bases
normalised Gaussians. A weight reaches the innovation through the observer's own linear dynamics (Schröder's error
transfer function): the response to its basis function is filtered by them, and the weights follow the innovation along
these responses.
"""

from __future__ import annotations

import math

import numpy as np

from ...jit import njit
from ..layout import (
    ANGLE_COUNTED,
    FRICTION_LOAD,
    FRICTION_WEIGHTS,
    GAP,
    GAP_CENTRES,
    GAP_WEIGHTS,
    NETWORK,
    NETWORK_PARAMETERS,
    SPEED_LOAD,
    SPEED_MOTOR,
    TORQUE_ACTUATOR,
    TWIST,
    WEIGHTS,
    size,
)
from ..records import reads
from ..runner import INIT, STEP
from ..two_mass_model import advance, clip, gap_argument
from .speed_observer import SHORT, innovation_of, load_slips, start_again_if_lost, write

_parameters, _memory = reads(NETWORK_PARAMETERS), reads(NETWORK)
_SIZE = size(NETWORK)

#: Numerics: width of a Gaussian over the distance of the centres; at a neighbour's centre it has 0.36, so that the sum
#: of both is smooth.
WIDTH = 0.7


@njit(INIT, cache=True)
def init(parameters):
    return np.zeros(_SIZE)


@njit(cache=True)
def basis(v, count, values):
    """Normalised Gaussians with ``count`` centres from −1 to 1, at v; their mean centre and 1/width² come back."""
    v = clip(v, -1.0, 1.0)
    spacing = 2.0 / (count - 1)
    sharp = 1.0 / (WIDTH * spacing) ** 2
    total = 0.0
    for i in range(count):
        apart = v - (i * spacing - 1.0)
        values[i] = math.exp(-0.5 * sharp * apart * apart)
        total += values[i]
    centre = 0.0
    for i in range(count):
        values[i] /= total
        centre += values[i] * (i * spacing - 1.0)
    return centre, sharp


@njit(cache=True)
def _curves(own, memory, z, values):
    """Learned gap term and its slope at z, learned friction at the load's speed; both bases go to values."""
    weights = memory.weights
    v = z / own.twist_range
    centre, sharp = basis(v, GAP_CENTRES, values)
    gap, slope = 0.0, 0.0
    for i in range(GAP_WEIGHTS):
        place = (i + 1.0) / GAP_WEIGHTS
        upper, lower = values[GAP_WEIGHTS + 1 + i], values[GAP_WEIGHTS - 1 - i]
        gap += (upper - lower) * weights[i]
        slope += weights[i] * sharp * (upper * (place - centre) + lower * (place + centre))
    for i in range(GAP_WEIGHTS):
        values[i] = values[GAP_WEIGHTS + 1 + i] - values[GAP_WEIGHTS - 1 - i]
    slope = slope / own.twist_range if abs(v) < 1.0 else 0.0
    speed = clip(memory.common.x[SPEED_LOAD] / own.speed_range, -1.0, 1.0)
    basis(math.copysign(math.sqrt(abs(speed)), speed), FRICTION_WEIGHTS, values[GAP_WEIGHTS:])
    friction = 0.0
    for i in range(GAP_WEIGHTS, WEIGHTS):
        friction += values[i] * weights[i]
    return gap, slope, friction


@njit(cache=True)
def _reach(p, responses, i):
    """How far weight i moves the innovation: its filtered response in the measured speed."""
    before = 0.5 * p.counted
    return (1.0 - before) * responses[i, 1] + before * responses[i, 3]


@njit(cache=True)
def _learn(own, memory, innovation):
    """Weights along their filtered responses, as a Kalman filter with a constant variance of each weight would."""
    p, weights, responses = own.common.common, memory.weights, memory.responses
    total = own.innovation_variance
    for i in range(WEIGHTS):
        total += (own.step_gap if i < GAP_WEIGHTS else own.step_friction) * _reach(p, responses, i) ** 2
    for i in range(WEIGHTS):
        size = own.step_gap if i < GAP_WEIGHTS else own.step_friction
        bound = own.bound_gap if i < GAP_WEIGHTS else own.bound_friction
        weights[i] = clip(weights[i] + size * _reach(p, responses, i) * innovation / total, -bound, bound)


@njit(cache=True)
def _respond(p, responses, inside, slips, values):
    """The filtered responses a substep on; ``inside``: slope of the whole gap curve, ``slips``: the load turns."""
    A = p.transition
    for i in range(WEIGHTS):
        x0, x1, x2 = responses[i, 0], responses[i, 1], responses[i, 2]
        gap = inside * (x0 + p.lead_middle * (x1 - x2))
        load = 0.0
        if i < GAP_WEIGHTS:
            gap += values[i]
        elif slips:
            load = values[i]
        for j in range(3):
            responses[i, j] = (
                A[j, 0] * x0 + A[j, 1] * x1 + A[j, 2] * x2 + A[j, GAP] * gap + A[j, FRICTION_LOAD] * load
            )
        if not slips:
            responses[i, 2] = 0.0


@njit(cache=True)
def _correct_responses(gain, responses, out, before):
    """What the observer's gain takes from the responses of a sample: ``out`` is each one's part of the innovation."""
    for i in range(WEIGHTS):
        for j in range(3):
            responses[i, j] -= gain[j] * out[i]
        responses[i, 3] = before[i] - gain[4] * out[i]


@njit(cache=True)
def _predict(own, memory, torque, values):
    """Observer and responses a sample on, in substeps, without the correction."""
    observer, s = own.common, memory.common
    p, x = observer.common, s.x
    before, x[ANGLE_COUNTED] = x[SPEED_MOTOR], 0.0
    for _ in range(int(p.substeps)):
        z = gap_argument(x, p.lead_middle)
        learned, slope, friction = _curves(own, memory, z, values)
        gap = clip(z, -observer.half_gap, observer.half_gap) + learned
        inside = _slope(observer, z, slope)
        n0, n1, n2, n3, turn, _, load = advance(p, x, -friction, observer.coulomb, gap, torque)
        s.friction = load
        _respond(p, memory.responses, inside, load_slips(observer, s), values)
        x[TWIST], x[SPEED_MOTOR], x[SPEED_LOAD], x[TORQUE_ACTUATOR] = n0, n1, n2, n3
        x[ANGLE_COUNTED] += turn
    s.moved = x[SPEED_MOTOR] - before


@njit(cache=True, inline="always")
def _slope(observer, z, learned):
    """Slope of the whole gap curve at z."""
    return clip((1.0 if abs(z) < observer.half_gap else 0.0) + learned, 0.0, 1.0)


@njit(cache=True)
def _write(own, memory, values, outputs):
    """All outputs; both bases at the estimate go to values."""
    observer, s = own.common, memory.common
    p, twist = observer.common, s.x[TWIST]
    z = gap_argument(s.x, p.lead_middle)
    learned, slope, friction = _curves(own, memory, z, values)
    gap_model = clip(twist, -observer.half_gap, observer.half_gap)
    gap = gap_model + learned
    write(observer, s, outputs)
    # A learned curve is nowhere exactly flat: where it is nearly so, the twist counts as free.
    outputs[1] = 0.0 if _slope(observer, z, slope) > 0.5 else twist - gap
    outputs[4] += p.stiffness * (gap_model - gap)
    outputs[5] += friction
    outputs[6] = 2.0 * observer.half_gap
    for i in range(GAP_WEIGHTS):
        outputs[6] += 2.0 * own.end_basis[i] * memory.weights[i]


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    own, memory = _parameters(parameters), _memory(state)
    observer, s, responses = own.common, memory.common, memory.responses
    p, x = observer.common, s.x
    values = np.empty(WEIGHTS + GAP_CENTRES)
    out, before = np.empty(WEIGHTS), np.empty(WEIGHTS)
    torque, innovation, faults = innovation_of(observer, s, inputs, faults)
    blind = s.blind > SHORT * p.hold
    gain = own.fast_gain if blind else own.gain
    # Nothing is learned from a torque or a speed that is not known, nor soon after both.
    if faults & 3 == 0 and not blind:
        _learn(own, memory, innovation)
    for i in range(WEIGHTS):
        out[i], before[i] = _reach(p, responses, i), responses[i, 1]
    _write(own, memory, values, outputs)
    _predict(own, memory, torque, values)
    _correct_responses(gain, responses, out, before)
    for i in range(4):
        x[i] += gain[i] * innovation
    x[ANGLE_COUNTED] += 0.5 * p.dt * (gain[1] + gain[4]) * innovation
    if start_again_if_lost(p, s):
        for i in range(WEIGHTS):
            for j in range(4):
                responses[i, j] = 0.0
    return faults

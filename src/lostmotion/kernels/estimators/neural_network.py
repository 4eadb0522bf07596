"""Intelligent observer: radial-basis networks that learn what friction and gap curve of the model miss: one step.

Total gap curve clip(z, ±half) + Σ gap weight·ψ(z), total friction = model + Σ friction weight·φ(speed_load), both bases
normalised Gaussians. A weight reaches the innovation through the observer's own linear dynamics (Schröder's error
transfer function): the response to its basis function is filtered by them, and the weights follow the innovation along
these responses.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .motor_speed import (
    BLIND,
    COULOMB,
    FREE,
    FRICTION,
    HALF,
    MOVED,
    SHORT,
    SIZE,
    STARTED,
    innovation_of,
    outputs_of,
    restart,
)  # fmt: skip
from .runner import INIT, STEP
from .two_mass_model import (
    ANGLE,
    AVERAGED,
    DT,
    HOLD,
    LEAD_MIDDLE,
    LOST,
    PIECES,
    RATIO_MINUS,
    RATIO_PLUS,
    STIFFNESS,
    advance,
    clip,
)  # fmt: skip

#: The gap curve is odd: each weight serves two of its centres, and the one in the middle is zero. (A constant in the
#: gap curve only moves the zero of the twist, which no speed can tell.)
GAP_CENTRES, N_GAP, N_FRICTION = 17, 8, 13
WEIGHTS_COUNT = N_GAP + N_FRICTION

# Own parameters: gain of the observer (5), that soon after all inputs were missing (5), range of the twist and of the
# load speed, step of both learnings, variance of the innovation, largest weights, then the gap's basis at the end of
# its range.
GAIN, FAST_GAIN, TWIST_RANGE, SPEED_RANGE = FREE, FREE + 5, FREE + 10, FREE + 11
STEP_GAP, STEP_FRICTION, INNOVATION = FREE + 12, FREE + 13, FREE + 14
BOUND_GAP, BOUND_FRICTION, END_BASIS = FREE + 15, FREE + 16, FREE + 17

# Places in the state: weights, then the filtered responses (twist, speed_motor, speed_load, speed_motor_previous).
WEIGHTS = SIZE
RESPONSE = WEIGHTS + WEIGHTS_COUNT
TOTAL = RESPONSE + 4 * WEIGHTS_COUNT

#: Width of a Gaussian over the distance of the centres (chosen: neighbours overlap at 0.36).
WIDTH = 0.7


@njit(INIT, cache=True)
def init(p):
    return np.zeros(TOTAL)


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
def _curves(p, s, z, values):
    """Learned gap term and its slope at z, learned friction at the load's speed; both bases go to values."""
    v = z / p[TWIST_RANGE]
    centre, sharp = basis(v, GAP_CENTRES, values)
    gap, slope = 0.0, 0.0
    for i in range(N_GAP):
        place = (i + 1.0) / N_GAP
        upper, lower = values[N_GAP + 1 + i], values[N_GAP - 1 - i]
        gap += (upper - lower) * s[WEIGHTS + i]
        slope += s[WEIGHTS + i] * sharp * (upper * (place - centre) + lower * (place + centre))
    for i in range(N_GAP):
        values[i] = values[N_GAP + 1 + i] - values[N_GAP - 1 - i]
    slope = slope / p[TWIST_RANGE] if abs(v) < 1.0 else 0.0
    speed = clip(s[2] / p[SPEED_RANGE], -1.0, 1.0)
    basis(math.copysign(math.sqrt(abs(speed)), speed), N_FRICTION, values[N_GAP:])
    friction = 0.0
    for i in range(N_GAP, WEIGHTS_COUNT):
        friction += values[i] * s[WEIGHTS + i]
    return gap, slope, friction


@njit(cache=True)
def _reach(p, s, i):
    """How far weight i moves the innovation: its filtered response in the measured speed."""
    at = RESPONSE + 4 * i
    before = 0.5 * p[AVERAGED]
    return (1.0 - before) * s[at + 1] + before * s[at + 3]


@njit(cache=True)
def _learn(p, s, innovation):
    """Weights along their filtered responses, as a Kalman filter with a constant variance of each weight would."""
    total = p[INNOVATION]
    for i in range(WEIGHTS_COUNT):
        total += (p[STEP_GAP] if i < N_GAP else p[STEP_FRICTION]) * _reach(p, s, i) ** 2
    for i in range(WEIGHTS_COUNT):
        size = p[STEP_GAP] if i < N_GAP else p[STEP_FRICTION]
        bound = p[BOUND_GAP] if i < N_GAP else p[BOUND_FRICTION]
        s[WEIGHTS + i] = clip(s[WEIGHTS + i] + size * _reach(p, s, i) * innovation / total, -bound, bound)


@njit(cache=True)
def _respond(p, s, inside, slips, values):
    """The filtered responses a piece on; ``inside``: slope of the whole gap curve, ``slips``: the load turns."""
    lead = p[LEAD_MIDDLE]
    for i in range(WEIGHTS_COUNT):
        at = RESPONSE + 4 * i
        x0, x1, x2 = s[at], s[at + 1], s[at + 2]
        gap = inside * (x0 + lead * (x1 - x2))
        load = 0.0
        if i < N_GAP:
            gap += values[i]
        elif slips:
            load = values[i]
        s[at] = p[0] * x0 + p[1] * x1 + p[2] * x2 + p[5] * gap + p[7] * load
        s[at + 1] = p[8] * x0 + p[9] * x1 + p[10] * x2 + p[13] * gap + p[15] * load
        s[at + 2] = p[16] * x0 + p[17] * x1 + p[18] * x2 + p[21] * gap + p[23] * load
        if not slips:
            s[at + 2] = 0.0


@njit(cache=True)
def _correct_responses(p, s, gain, out, before):
    """What the observer's gain takes from the responses of a sample: ``out`` is each one's part of the innovation."""
    for i in range(WEIGHTS_COUNT):
        at = RESPONSE + 4 * i
        for j in range(3):
            s[at + j] -= p[gain + j] * out[i]
        s[at + 3] = before[i] - p[gain + 4] * out[i]


@njit(cache=True)
def _predict(p, s, torque, values):
    """Observer and responses a sample on, in pieces, without the correction."""
    before, s[ANGLE] = s[1], 0.0
    for _ in range(int(p[PIECES])):
        z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
        learned, slope, friction = _curves(p, s, z, values)
        gap = clip(z, -p[HALF], p[HALF]) + learned
        inside = clip((1.0 if abs(z) < p[HALF] else 0.0) + slope, 0.0, 1.0)
        n0, n1, n2, n3, turn, _, load = advance(p, s[0], s[1], s[2], s[3], -friction, p[COULOMB], gap, torque)
        _respond(p, s, inside, abs(load) >= p[COULOMB] * min(p[RATIO_PLUS], p[RATIO_MINUS]), values)
        s[0], s[1], s[2], s[3], s[FRICTION] = n0, n1, n2, n3, load
        s[ANGLE] += turn
    s[MOVED] = s[1] - before


@njit(cache=True)
def _write(p, s, gap_now, inside, friction, outputs):
    outputs_of(p, s, outputs)
    # A learned curve is nowhere exactly flat: where it is nearly so, the twist counts as free.
    outputs[1] = 0.0 if inside > 0.5 else s[0] - gap_now
    outputs[4] += p[STIFFNESS] * (clip(s[0], -p[HALF], p[HALF]) - gap_now)
    outputs[5] += friction
    outputs[6] = 2.0 * p[HALF]
    for i in range(N_GAP):
        outputs[6] += 2.0 * p[END_BASIS + i] * s[WEIGHTS + i]


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    values = np.empty(WEIGHTS_COUNT + GAP_CENTRES)
    out, before = np.empty(WEIGHTS_COUNT), np.empty(WEIGHTS_COUNT)
    torque, innovation, faults = innovation_of(p, s, inputs, faults)
    blind = s[BLIND] > SHORT * p[HOLD]
    gain = FAST_GAIN if blind else GAIN
    # Nothing is learned from a torque or a speed that is not known, nor soon after both.
    if faults & 3 == 0 and not blind:
        _learn(p, s, innovation)
    for i in range(WEIGHTS_COUNT):
        out[i], before[i] = _reach(p, s, i), s[RESPONSE + 4 * i + 1]
    z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
    learned, slope, friction = _curves(p, s, z, values)
    inside = clip((1.0 if abs(z) < p[HALF] else 0.0) + slope, 0.0, 1.0)
    _write(p, s, clip(s[0], -p[HALF], p[HALF]) + learned, inside, friction, outputs)
    _predict(p, s, torque, values)
    _correct_responses(p, s, gain, out, before)
    for i in range(4):
        s[i] += p[gain + i] * innovation
    s[ANGLE] += 0.5 * p[DT] * (p[gain + 1] + p[gain + 4]) * innovation
    if not (abs(s[0]) < LOST and abs(s[1]) < LOST and abs(s[2]) < LOST and abs(s[3]) < LOST):
        restart(p, s, 0.0)
        s[STARTED] = 0.0
        for i in range(RESPONSE, TOTAL):
            s[i] = 0.0
    return faults

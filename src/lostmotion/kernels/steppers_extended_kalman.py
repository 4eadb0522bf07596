"""Extended Kalman filter with backlash, load torque and Coulomb level as states: one step.

States: those of ``steppers_model``, then torque_load, backlash, coulomb. The gap enters by its mean over the estimate's
own spread (statistical linearisation), so its slope is the chance of being inside it and never jumps.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .steppers import INIT, STEP
from .steppers_model import (
    DAMPING, KIND, LEAD, LEAD_MIDDLE, LOST, MEAN_BEFORE, MEAN_NOW, MEMORY, N_SENSORS, PROCESS, RATIO_MINUS,
    RATIO_PLUS, REST_LOAD, REST_MOTOR, COULOMB_MOTOR, SPEED_LOAD, SPEED_MOTOR, START, START_VARIANCE, STIFFNESS,
    TORQUE_SHAFT, TWIST, VARIANCE, advance, clip, mean_gap, sensor_believed, torque_believed, write_estimates,
)  # fmt: skip

N = 8
ACTUATOR, PREVIOUS, LOAD_TORQUE, BACKLASH, COULOMB = 3, 4, 5, 6, 7

# Places in the state.
COVARIANCE = N
STARTED = N + N * N
TORQUE = STARTED + 1
FRICTION = STARTED + 2
BEFORE = STARTED + 3  # the four moving states before the last prediction: what the model alone has moved
SENSOR_MEMORY = STARTED + 7
SIZE = SENSOR_MEMORY + 4 * MEMORY


@njit(cache=True)
def _restart(p, s, speed):
    """Both inertias at ``speed``, everything else as known beforehand."""
    for i in range(N):
        s[i] = p[START + i]
        for j in range(N):
            s[COVARIANCE + i * N + j] = p[START_VARIANCE + i] if i == j else 0.0
    s[1] = s[2] = s[PREVIOUS] = speed
    s[ACTUATOR] = s[TORQUE]
    for i in range(4):
        s[BEFORE + i] = s[i]
    s[FRICTION] = 0.0
    s[STARTED] = 1.0


@njit(INIT, cache=True)
def init(p):
    state = np.zeros(SIZE)
    _restart(p, state, 0.0)
    state[STARTED] = 0.0
    return state


@njit(cache=True)
def _spread(s, lead):
    """Standard deviation of twist + lead·rate against the edge of the gap."""
    c = COVARIANCE
    p00, p01, p02 = s[c], s[c + 1], s[c + 2]
    p11, p12, p22 = s[c + N + 1], s[c + N + 2], s[c + 2 * N + 2]
    variance = p00 + 2.0 * lead * (p01 - p02) + lead * lead * (p11 - 2.0 * p12 + p22)
    variance += 0.25 * s[c + BACKLASH * N + BACKLASH]
    return math.sqrt(max(variance, 0.0))


@njit(cache=True)
def _row(p, s, kind, h):
    """Predicted sensor value; its row over the states goes to h."""
    for i in range(N):
        h[i] = 0.0
    if kind == SPEED_MOTOR:
        h[1], h[PREVIOUS] = p[MEAN_NOW], p[MEAN_BEFORE]
        return p[MEAN_NOW] * s[1] + p[MEAN_BEFORE] * s[PREVIOUS]
    if kind == SPEED_LOAD:
        h[2] = 1.0
        return s[2]
    if kind == TWIST:
        h[0] = 1.0
        return s[0]
    k, d, lead = p[STIFFNESS], p[DAMPING], p[LEAD]
    gap, above, below = mean_gap(s[0] + lead * (s[1] - s[2]), 0.5 * s[BACKLASH], _spread(s, lead))
    inside = 1.0 - above - below
    h[0] = k * (1.0 - inside)
    h[1] = d - k * lead * inside
    h[2] = -h[1]
    h[BACKLASH] = -0.5 * k * (above - below)
    return k * (s[0] - gap) + d * (s[1] - s[2])


@njit(cache=True)
def _correct(s, h, innovation, variance, gain):
    """Scalar update; ``gain`` holds P·hᵀ on entry."""
    for i in range(N):
        s[i] += gain[i] / variance * innovation
    for i in range(N):
        for j in range(i, N):
            value = s[COVARIANCE + i * N + j] - gain[i] * gain[j] / variance
            s[COVARIANCE + i * N + j] = value
            s[COVARIANCE + j * N + i] = value


@njit(cache=True)
def _jacobian(p, inside, edge, motor, load, coulomb, f):
    """f (4, 8): the moving states' derivatives; rows 4 to 7 are the speed before and three constants."""
    lead = p[LEAD_MIDDLE]
    for i in range(3):
        gap = p[8 * i + 5]
        f[i, 0] = p[8 * i] + gap * inside
        f[i, 1] = p[8 * i + 1] + gap * inside * lead
        f[i, 2] = p[8 * i + 2] - gap * inside * lead
        f[i, 3] = p[8 * i + 3]
        f[i, 4] = 0.0
        f[i, 5] = -p[8 * i + 7]
        f[i, 6] = 0.5 * gap * edge
        f[i, 7] = 0.0
    for j in range(N):
        f[3, j] = 0.0
    f[3, 3] = p[27]
    if abs(motor) < p[COULOMB_MOTOR]:
        for j in range(7):
            slope = f[1, j] * p[REST_MOTOR]
            for i in range(3):
                f[i, j] += p[8 * i + 6] * slope
    plus, minus = p[RATIO_PLUS], p[RATIO_MINUS]
    if load >= plus * coulomb:
        for i in range(3):
            f[i, 7] += p[8 * i + 7] * plus
    elif load <= -minus * coulomb:
        for i in range(3):
            f[i, 7] -= p[8 * i + 7] * minus
    else:
        for j in range(7):
            slope = f[2, j] * p[REST_LOAD]
            for i in range(3):
                f[i, j] += p[8 * i + 7] * slope


@njit(cache=True)
def _predict(p, s, torque, f, work):
    z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
    gap, above, below = mean_gap(z, 0.5 * s[BACKLASH], _spread(s, p[LEAD_MIDDLE]))
    n0, n1, n2, n3, motor, load = advance(
        p, s[0], s[1], s[2], s[3], s[LOAD_TORQUE], s[COULOMB], gap, torque
    )
    _jacobian(p, 1.0 - above - below, above - below, motor, load, s[COULOMB], f)
    c = COVARIANCE
    for i in range(4):
        for j in range(N):
            work[i, j] = (
                f[i, 0] * s[c + j]
                + f[i, 1] * s[c + N + j]
                + f[i, 2] * s[c + 2 * N + j]
                + f[i, 3] * s[c + 3 * N + j]
                + f[i, 5] * s[c + 5 * N + j]
                + f[i, 6] * s[c + 6 * N + j]
                + f[i, 7] * s[c + 7 * N + j]
            )
    s[c + 4 * N + 4] = s[c + N + 1]
    for j in range(5, N):
        s[c + 4 * N + j] = s[c + j * N + 4] = s[c + N + j]
    for i in range(4):
        for j in range(i, 4):
            total = 0.0
            for k in range(N):
                total += work[i, k] * f[j, k]
            s[c + i * N + j] = s[c + j * N + i] = total
        s[c + i * N + 4] = s[c + 4 * N + i] = work[i, 1]
        for j in range(5, N):
            s[c + i * N + j] = s[c + j * N + i] = work[i, j]
    for i in range(N):
        s[c + i * N + i] += p[PROCESS + i]
    for i in range(4):
        s[BEFORE + i] = s[i]
    s[PREVIOUS] = s[1]
    s[0], s[1], s[2], s[3], s[FRICTION] = n0, n1, n2, n3, load


@njit(cache=True)
def _moved(p, s, kind):
    """Change of a predicted signal over the last sample by the model alone."""
    if kind == SPEED_MOTOR:
        return s[1] - s[BEFORE + 1]
    if kind == SPEED_LOAD:
        return s[2] - s[BEFORE + 2]
    twist = s[0] - s[BEFORE]
    return twist if kind == TWIST else p[STIFFNESS] * twist


@njit(cache=True)
def _lost(s):
    for i in range(N):
        if not abs(s[i]) < LOST or not s[COVARIANCE + i * N + i] < LOST * LOST:
            return True
    return False


@njit(cache=True)
def _write(p, s, outputs):
    c = COVARIANCE
    write_estimates(p, s[0], s[1], s[2], 0.5 * s[BACKLASH], s[FRICTION], outputs)
    outputs[6], outputs[7], outputs[8] = s[LOAD_TORQUE], s[BACKLASH], s[COULOMB]
    outputs[9] = math.sqrt(max(s[c], 0.0))
    outputs[10] = math.sqrt(max(s[c + N + 1], 0.0))
    outputs[11] = math.sqrt(max(s[c + 2 * N + 2], 0.0))
    for i in range(3):
        outputs[13 + i] = math.sqrt(max(s[c + (5 + i) * (N + 1)], 0.0))


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    f, work = np.empty((4, N)), np.empty((4, N))
    h, gain = work[0], work[1]
    torque, faults = torque_believed(p, s, TORQUE, inputs, faults)
    if s[STARTED] == 0.0:
        _restart(p, s, inputs[1] if int(p[KIND]) == SPEED_MOTOR and faults & 2 == 0 else 0.0)
    for i in range(int(p[N_SENSORS])):
        kind = int(p[KIND + i])
        predicted = _row(p, s, kind, h)
        variance = p[VARIANCE + i]
        deviation = math.sqrt(variance)
        for j in range(N):
            gain[j] = 0.0
            for k in range(N):
                gain[j] += s[COVARIANCE + j * N + k] * h[k]
        for j in range(N):
            variance += h[j] * gain[j]
        missing = faults & (2 << i) != 0
        verdict = sensor_believed(
            p, s, SENSOR_MEMORY + MEMORY * i, inputs[1 + i], missing, _moved(p, s, kind),
            inputs[1 + i] - predicted, variance, deviation,
        )  # fmt: skip
        if verdict == 0:
            _correct(s, h, inputs[1 + i] - predicted, variance, gain)
            s[BACKLASH] = clip(s[BACKLASH], 0.0, 20.0 * p[START + BACKLASH])
            s[COULOMB] = max(s[COULOMB], 0.0)
        elif verdict == 1:
            faults |= 2 << i
        else:
            backlash, coulomb = s[BACKLASH], s[COULOMB]
            _restart(p, s, inputs[1 + i] if kind <= SPEED_LOAD else s[1])
            s[BACKLASH], s[COULOMB] = backlash, coulomb
            faults |= 2 << i
    if _lost(s):
        _restart(p, s, 0.0)
        s[STARTED] = 0.0
    _row(p, s, TORQUE_SHAFT, h)
    variance = 0.0
    for j in range(N):
        for k in range(N):
            variance += h[j] * s[COVARIANCE + j * N + k] * h[k]
    outputs[12] = math.sqrt(max(variance, 0.0))
    _write(p, s, outputs)
    _predict(p, s, torque, f, work)
    if _lost(s):
        _restart(p, s, 0.0)
        s[STARTED] = 0.0
    return faults

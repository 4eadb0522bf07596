"""Interacting models — contact at the upper edge, gap, contact at the lower edge — with their probabilities: one step.

Each model is a Kalman filter with the gap term of its own side: +half, the argument itself, −half. The chance to change
the model is that of the argument lying on that side, from the model's own mean and spread.

States of a model: those of ``steppers_model``, then torque_load.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .steppers import INIT, STEP
from .steppers_model import (
    ANGLE,
    AVERAGED,
    COULOMB_MOTOR,
    DAMPING,
    DOUBT,
    DT,
    FROZEN,
    JUMP,
    KIND,
    LEAD,
    LEAD_MIDDLE,
    LOST,
    MEMORY,
    N_SENSORS,
    OWN,
    PIECES,
    PROCESS,
    RATIO_MINUS,
    RATIO_PLUS,
    REST_LOAD,
    REST_MOTOR,
    SCALE,
    SPEED_LOAD,
    SPEED_MOTOR,
    START,
    START_AGAIN,
    START_VARIANCE,
    STIFFNESS,
    TWIST,
    USE,
    VARIANCE,
    advance,
    doubt,
    mean_gap,
    next_count,
    sensor_believed,
    torque_believed,
    write_estimates,
)  # fmt: skip

N, MODELS = 6, 3
LOAD_TORQUE = 5
ONE = N + N * N  # a model: its mean, then its covariance

# Own parameters: half of the backlash, Coulomb level, smallest chance of a change to any model.
HALF, COULOMB, LEAST = OWN, OWN + 1, OWN + 2

# Places in the state.
CHANCE = MODELS * ONE
STARTED = CHANCE + MODELS
TORQUE = STARTED + 1
FRICTION = STARTED + 2
BEFORE = STARTED + 3
SENSOR_MEMORY = STARTED + 6
SIZE = SENSOR_MEMORY + 4 * MEMORY


@njit(cache=True)
def _restart(p, s, speed, count):
    for m in range(MODELS):
        at = m * ONE
        for i in range(count):
            s[at + i] = p[START + i]
            for j in range(N):
                s[at + N + i * N + j] = s[at + N + j * N + i] = 0.0
            s[at + N + i * N + i] = p[START_VARIANCE + i]
        s[at] = (1 - m) * p[HALF]
        s[at + 1] = s[at + 2] = speed
        s[at + 3] = s[TORQUE]
        s[CHANCE + m] = 1.0 / MODELS
    for i in range(3):
        s[BEFORE + i] = s[ONE + i]
    s[FRICTION] = 0.0
    s[STARTED] = 1.0


@njit(INIT, cache=True)
def init(p):
    s = np.zeros(SIZE)
    _restart(p, s, 0.0, N)
    s[STARTED] = 0.0
    return s


@njit(cache=True)
def _row(p, s, m, kind, h):
    """Predicted sensor value of model m (from counts: of the angle turned); its row over the states goes to h."""
    at = m * ONE
    for i in range(N):
        h[i] = 0.0
    if kind == SPEED_MOTOR:
        state = ANGLE if p[AVERAGED] else 1
        h[state] = 1.0
        return s[at + state]
    if kind == SPEED_LOAD:
        h[2] = 1.0
        return s[at + 2]
    if kind == TWIST:
        h[0] = 1.0
        return s[at]
    return _torque(p, s, m, h)


@njit(cache=True)
def _torque(p, s, m, h):
    """Shaft torque of model m; its row goes to h[0 … 2]."""
    at, k = m * ONE, p[STIFFNESS]
    closed = m != 1
    h[0] = k if closed else 0.0
    h[1] = p[DAMPING] - (0.0 if closed else k * p[LEAD])
    h[2] = -h[1]
    edge = (1 - m) * p[HALF]
    return h[0] * (s[at] - edge) + h[1] * (s[at + 1] - s[at + 2])


@njit(cache=True)
def _correct(s, m, h, innovation, variance, gain):
    at, c = m * ONE, m * ONE + N
    for i in range(N):
        s[at + i] += gain[i] / variance * innovation
    for i in range(N):
        for j in range(i, N):
            value = s[c + i * N + j] - gain[i] * gain[j] / variance
            s[c + i * N + j] = value
            s[c + j * N + i] = value


@njit(cache=True)
def _sensor(p, s, i, value, missing, h, gain, innovation, variance):
    """One sensor in all models; returns whether it was not believed. h, gain (3, N); innovation, variance (3,)."""
    kind = int(p[KIND + i])
    best = 0
    for m in range(MODELS):
        innovation[m] = value * p[SCALE + i] - _row(p, s, m, kind, h[m])
        variance[m] = p[VARIANCE + i]
        for j in range(N):
            gain[m, j] = 0.0
            for k in range(N):
                gain[m, j] += s[m * ONE + N + j * N + k] * h[m, k]
        for j in range(N):
            variance[m] += h[m, j] * gain[m, j]
        if innovation[m] * innovation[m] * variance[best] < innovation[best] * innovation[best] * variance[m]:
            best = m
    moved = 0.0
    column = 1 if kind == SPEED_MOTOR else 2 if kind == SPEED_LOAD else 0
    for m in range(MODELS):
        moved += s[CHANCE + m] * s[m * ONE + column]
    moved -= s[BEFORE + column]
    if kind > TWIST:
        moved *= p[STIFFNESS]
    verdict = sensor_believed(
        p, s, SENSOR_MEMORY + MEMORY * i, i, value, missing, moved, innovation[best], variance[best]
    )  # fmt: skip
    if verdict in (FROZEN, JUMP):
        for m in range(MODELS):
            doubt(s, m * ONE + N, N, LOAD_TORQUE, math.exp(DOUBT * p[DT]))
    if verdict == START_AGAIN:
        _restart(p, s, value if kind <= SPEED_LOAD else s[ONE + 1], LOAD_TORQUE)
    if verdict == USE:
        _weigh(s, h, innovation, variance, gain)
    if kind == SPEED_MOTOR and p[AVERAGED]:
        for m in range(MODELS):
            next_count(p, i, s, m * ONE, m * ONE + N, N, value, verdict == USE)
    return verdict != USE


@njit(cache=True)
def _weigh(s, h, innovation, variance, gain):
    """Every model corrected, and its chance by how likely the sample was."""
    total = 0.0
    for m in range(MODELS):
        # Student's t with three degrees of freedom instead of Gauss: a mode that no model has must not decide.
        tail = 1.0 + innovation[m] * innovation[m] / (3.0 * variance[m])
        s[CHANCE + m] /= tail * tail * math.sqrt(variance[m])
        total += s[CHANCE + m]
        _correct(s, m, h[m], innovation[m], variance[m], gain[m])
    for m in range(MODELS):
        s[CHANCE + m] /= total


@njit(cache=True)
def _mixed(p, s, mixed):
    """Chances of the models in the next sample; each model's start for it, mean and covariance, in mixed (3, ONE)."""
    lead = p[LEAD_MIDDLE]
    change = np.empty((MODELS, MODELS))
    for m in range(MODELS):
        at, c = m * ONE, m * ONE + N
        z = s[at] + lead * (s[at + 1] - s[at + 2])
        variance = s[c] + 2.0 * lead * (s[c + 1] - s[c + 2])
        variance += lead * lead * (s[c + N + 1] - 2.0 * s[c + N + 2] + s[c + 2 * N + 2])
        _, above, below = mean_gap(z, p[HALF], math.sqrt(max(variance, 0.0)))
        kept = 1.0 - MODELS * p[LEAST]
        change[m, 0] = s[CHANCE + m] * (p[LEAST] + kept * above)
        change[m, 1] = s[CHANCE + m] * (p[LEAST] + kept * (1.0 - above - below))
        change[m, 2] = s[CHANCE + m] * (p[LEAST] + kept * below)
    for m in range(MODELS):
        total = change[0, m] + change[1, m] + change[2, m]
        for i in range(ONE):
            mixed[m, i] = 0.0
        for n in range(MODELS):
            change[n, m] /= total
            for i in range(N):
                mixed[m, i] += change[n, m] * s[n * ONE + i]
        for n in range(MODELS):
            weight, at = change[n, m], n * ONE
            for i in range(N):
                first = weight * (s[at + i] - mixed[m, i])
                for j in range(i, N):
                    mixed[m, N + i * N + j] += (
                        first * (s[at + j] - mixed[m, j]) + weight * s[at + N + i * N + j]
                    )
        for i in range(N):
            for j in range(i):
                mixed[m, N + i * N + j] = mixed[m, N + j * N + i]
        change[0, m] = total
    for m in range(MODELS):
        s[CHANCE + m] = change[0, m]


@njit(cache=True)
def _jacobian(p, inside, motor, load, f):
    """f (5, N): derivatives of all states but the load torque, which stays."""
    lead = p[LEAD_MIDDLE]
    for i in range(LOAD_TORQUE):
        gap = p[8 * i + 5] * inside
        f[i, 0] = p[8 * i] + gap
        f[i, 1] = p[8 * i + 1] + gap * lead
        f[i, 2] = p[8 * i + 2] - gap * lead
        f[i, 3] = p[8 * i + 3]
        f[i, 4] = 0.0
        f[i, 5] = -p[8 * i + 7]
    f[ANGLE, ANGLE] = 1.0
    if abs(motor) < p[COULOMB_MOTOR]:
        _add_rest(p, 6, p[REST_MOTOR], f, 1)
    if -p[RATIO_MINUS] * p[COULOMB] < load < p[RATIO_PLUS] * p[COULOMB]:
        _add_rest(p, 7, p[REST_LOAD], f, 2)


@njit(cache=True)
def _add_rest(p, column, torque, f, speed):
    """The friction that brings ``speed`` to rest follows all that moves it."""
    for j in range(N):
        if j != ANGLE:
            slope = f[speed, j] * torque
            for i in range(LOAD_TORQUE):
                f[i, j] += p[8 * i + column] * slope


@njit(cache=True)
def _predict(p, s, m, x, torque, f, work):
    """Model m a piece of a sample on, from the mixed start x; returns the load's Coulomb torque."""
    at, c = m * ONE, m * ONE + N
    gap = (1 - m) * p[HALF]
    if m == 1:
        gap = x[0] + p[LEAD_MIDDLE] * (x[1] - x[2])
    n0, n1, n2, n3, turn, motor, load = advance(
        p, x[0], x[1], x[2], x[3], x[LOAD_TORQUE], p[COULOMB], gap, torque
    )
    _jacobian(p, 1.0 if m == 1 else 0.0, motor, load, f)
    for i in range(LOAD_TORQUE):
        for j in range(N):
            total = 0.0
            for k in range(N):
                total += f[i, k] * x[N + k * N + j]
            work[i, j] = total
    for i in range(LOAD_TORQUE):
        for j in range(i, LOAD_TORQUE):
            total = 0.0
            for k in range(N):
                total += work[i, k] * f[j, k]
            s[c + i * N + j] = s[c + j * N + i] = total
        s[c + i * N + LOAD_TORQUE] = s[c + LOAD_TORQUE * N + i] = work[i, LOAD_TORQUE]
    s[c + LOAD_TORQUE * (N + 1)] = x[N + LOAD_TORQUE * (N + 1)]
    for i in range(N):
        s[c + i * N + i] += p[PROCESS + i]
    s[at], s[at + 1], s[at + 2], s[at + 3] = n0, n1, n2, n3
    s[at + ANGLE], s[at + LOAD_TORQUE] = x[ANGLE] + turn * p[AVERAGED], x[LOAD_TORQUE]
    return load


@njit(cache=True)
def _recover(p, s):
    for m in range(MODELS):
        at = m * ONE
        bad = not s[CHANCE + m] <= 1.0 + 1e-9
        for i in range(N):
            bad = bad or not abs(s[at + i]) < LOST or not s[at + N + i * N + i] < LOST * LOST
        if bad:
            _restart(p, s, 0.0, N)
            s[STARTED] = 0.0
            return


@njit(cache=True)
def _write(p, s, h, work, outputs):
    """All outputs: the mixture's means and standard deviations."""
    mean, second = work[0], work[1]
    for i in range(N):
        mean[i] = second[i] = 0.0
        for m in range(MODELS):
            mean[i] += s[CHANCE + m] * s[m * ONE + i]
        for m in range(MODELS):
            apart = s[m * ONE + i] - mean[i]
            second[i] += s[CHANCE + m] * (s[m * ONE + N + i * N + i] + apart * apart)
    write_estimates(p, mean[0], mean[1], mean[2], p[HALF], s[FRICTION], outputs)
    torque, square = 0.0, 0.0
    for m in range(MODELS):
        one = _torque(p, s, m, h)
        variance, c = 0.0, m * ONE + N
        for j in range(3):
            for k in range(3):
                variance += h[j] * h[k] * s[c + j * N + k]
        torque += s[CHANCE + m] * one
        square += s[CHANCE + m] * (one * one + variance)
    outputs[4] = torque
    outputs[6] = mean[LOAD_TORQUE]
    for m in range(MODELS):
        outputs[7 + m] = s[CHANCE + m]
    for i in range(3):
        outputs[10 + i] = math.sqrt(max(second[i], 0.0))
        s[BEFORE + i] = mean[i]
    outputs[13] = math.sqrt(max(square - torque * torque, 0.0))
    outputs[14] = math.sqrt(max(second[LOAD_TORQUE], 0.0))


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    mixed, f, work = np.empty((MODELS, ONE)), np.empty((LOAD_TORQUE, N)), np.empty((LOAD_TORQUE, N))
    h, gain = np.empty((MODELS, N)), np.empty((MODELS, N))
    torque, faults = torque_believed(p, s, TORQUE, inputs, faults)
    if s[STARTED] == 0.0:
        _restart(p, s, inputs[1] if int(p[KIND]) == SPEED_MOTOR and faults & 2 == 0 else 0.0, N)
    for i in range(int(p[N_SENSORS])):
        if _sensor(p, s, i, inputs[1 + i], faults & (2 << i) != 0, h, gain, work[0], work[1]):
            faults |= 2 << i
    _recover(p, s)
    _write(p, s, h[0], work, outputs)
    for _ in range(int(p[PIECES])):
        _mixed(p, s, mixed)
        s[FRICTION] = 0.0
        for m in range(MODELS):
            s[FRICTION] += s[CHANCE + m] * _predict(p, s, m, mixed[m], torque, f, work)
    _recover(p, s)
    return faults

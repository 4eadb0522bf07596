"""Interacting models — contact at the upper edge, gap, contact at the lower edge — with their probabilities: one step.

Each model is an extended Kalman filter with the gap term of its own side: +half, the argument itself, −half.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from ..runner import INIT, STEP
from ..two_mass_model import (
    ANGLE,
    AVERAGED,
    COULOMB_MOTOR,
    KIND,
    LEAD_MIDDLE,
    N_SENSORS,
    PIECES,
    PROCESS,
    RATIO_MINUS,
    RATIO_PLUS,
    REST_LOAD,
    REST_MOTOR,
    SPEED_MOTOR,
    advance,
    blind_samples,
    doubt_torque,
    torque_believed,
)  # fmt: skip
from .correction import sensor, write
from .mixing import PART, mix
from .state import (
    BLIND,
    CHANCE,
    COULOMB,
    FRICTION,
    GAP_PROCESS,
    HALF,
    LOAD_TORQUE,
    MODELS,
    MOVING,
    ONE,
    SIZE,
    STARTED,
    TORQUE,
    N,
    recover,
    restart,
)  # fmt: skip


@njit(INIT, cache=True)
def init(p):
    s = np.zeros(SIZE)
    restart(p, s, 0.0, N)
    s[STARTED] = 0.0
    return s


@njit(cache=True)
def _jacobian(p, inside, motor, load, coulomb, f):
    """f (5, 7): derivatives of the moving states; not by the angle counted (column 4), on which only itself depends."""
    lead = p[LEAD_MIDDLE]
    for i in range(MOVING):
        gap = p[8 * i + 5] * inside
        f[i, 0] = p[8 * i] + gap
        f[i, 1] = p[8 * i + 1] + gap * lead
        f[i, 2] = p[8 * i + 2] - gap * lead
        f[i, 3] = p[8 * i + 3]
        f[i, 5] = -p[8 * i + 7]
        f[i, 6] = 0.0
    if abs(motor) < p[COULOMB_MOTOR]:
        _add_rest(p, 6, p[REST_MOTOR], f, 1)
    slips = 0.0
    if load >= p[RATIO_PLUS] * coulomb:
        slips = p[RATIO_PLUS]
    elif load <= -p[RATIO_MINUS] * coulomb:
        slips = -p[RATIO_MINUS]
    else:
        _add_rest(p, 7, p[REST_LOAD], f, 2)
    for i in range(MOVING):
        f[i, 6] += p[8 * i + 7] * slips


@njit(cache=True)
def _add_rest(p, column, torque, f, speed):
    """The friction that brings ``speed`` to rest follows all that moves it."""
    for j in (0, 1, 2, 3, LOAD_TORQUE):
        slope = f[speed, j] * torque
        for i in range(MOVING):
            f[i, j] += p[8 * i + column] * slope


@njit(cache=True)
def _propagate(p, s, c, x, f, work):
    """Covariance a piece of a sample on, from that of the start x to s[c …]: F P Fᵀ + Q, without the twist's Q."""
    for i in range(MOVING):
        for j in range(N):
            work[i, j] = (
                f[i, 0] * x[N + j]
                + f[i, 1] * x[2 * N + j]
                + f[i, 2] * x[3 * N + j]
                + f[i, 3] * x[4 * N + j]
                + f[i, 5] * x[6 * N + j]
                + f[i, 6] * x[7 * N + j]
            )
    for j in range(N):
        work[ANGLE, j] += x[(1 + ANGLE) * N + j]
    for i in range(MOVING):
        for j in range(i, MOVING):
            value = (
                work[i, 0] * f[j, 0]
                + work[i, 1] * f[j, 1]
                + work[i, 2] * f[j, 2]
                + work[i, 3] * f[j, 3]
                + work[i, 5] * f[j, 5]
                + work[i, 6] * f[j, 6]
            )
            if j == ANGLE:
                value += work[i, ANGLE]
            s[c + i * N + j] = s[c + j * N + i] = value
        for j in range(MOVING, N):
            s[c + i * N + j] = s[c + j * N + i] = work[i, j]
    for i in range(MOVING, N):
        for j in range(MOVING, N):
            s[c + i * N + j] = x[N + i * N + j]
    for i in range(1, N):
        s[c + i * N + i] += p[PROCESS + i]


@njit(cache=True)
def _predict(p, s, m, x, torque, f, work):
    """Model m a piece of a sample on, from the mixed start x; returns the load's Coulomb torque."""
    at = m * ONE
    gap = (1 - m) * p[HALF]
    if m == 1:
        gap = x[0] + p[LEAD_MIDDLE] * (x[1] - x[2])
    n0, n1, n2, n3, turn, motor, load = advance(
        p, x[0], x[1], x[2], x[3], x[LOAD_TORQUE], x[COULOMB], gap, torque
    )
    _jacobian(p, 1.0 if m == 1 else 0.0, motor, load, x[COULOMB], f)
    _propagate(p, s, at + N, x, f, work)
    s[at + N] += p[GAP_PROCESS] if m == 1 else p[PROCESS]
    s[at], s[at + 1], s[at + 2], s[at + 3] = n0, n1, n2, n3
    s[at + ANGLE], s[at + LOAD_TORQUE] = x[ANGLE] + turn * p[AVERAGED], x[LOAD_TORQUE]
    s[at + COULOMB] = x[COULOMB]
    return load


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    mixed, parts = np.empty((MODELS, ONE)), np.empty((MODELS, PART))
    f, work = np.empty((MOVING, N)), np.empty((MOVING, N))
    torque, faults = torque_believed(p, s, TORQUE, inputs, faults)
    # While the torque is known, three models know the side well enough.
    s[BLIND] = blind_samples(p, s[BLIND], faults if faults & 1 else 0)
    for m in range(MODELS):
        doubt_torque(p, s, m * ONE + N, N, faults & 1 != 0, s[BLIND])
    if s[STARTED] == 0.0:
        restart(p, s, inputs[1] if int(p[KIND]) == SPEED_MOTOR and faults & 2 == 0 else 0.0, N)
    for i in range(int(p[N_SENSORS])):
        if sensor(p, s, i, inputs[1 + i], faults & (2 << i) != 0, f, work, mixed[0], mixed[1]):
            faults |= 2 << i
    recover(p, s)
    write(p, s, f[0], work, outputs)
    for _ in range(int(p[PIECES])):
        mix(p, s, mixed, parts)
        s[FRICTION] = 0.0
        for m in range(MODELS):
            s[FRICTION] += s[CHANCE + m] * _predict(p, s, m, mixed[m], torque, f, work)
    recover(p, s)
    return faults

"""Extended Kalman filter with backlash, load torque and Coulomb level as states: one step.

The gap enters by its mean over the estimate's own spread (statistical linearisation), so its slope is the chance of
being inside it and never jumps.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .steppers import INIT, STEP
from .steppers_model import (
    ANGLE,
    AVERAGED,
    COULOMB_MOTOR,
    LEAD_MIDDLE,
    PIECES,
    PROCESS,
    RATIO_MINUS,
    RATIO_PLUS,
    REST_LOAD,
    REST_MOTOR,
    advance,
    mean_gap,
)  # fmt: skip
from .steppers_tracking import (
    BACKLASH,
    BEFORE,
    COULOMB,
    COVARIANCE,
    FRICTION,
    LOAD_TORQUE,
    MOVING,
    N,
    begin,
    correct_all,
    new_state,
    recover,
    spread,
    write,
)  # fmt: skip


@njit(INIT, cache=True)
def init(p):
    return new_state(p)


@njit(cache=True)
def jacobian(p, inside, edge, motor, load, coulomb, f):
    """f (5, 8): derivatives of the moving states and of the angle counted; rows 5 to 7 are constants."""
    lead = p[LEAD_MIDDLE]
    for i in range(MOVING):
        gap = p[8 * i + 5]
        f[i, 0] = p[8 * i] + gap * inside
        f[i, 1] = p[8 * i + 1] + gap * inside * lead
        f[i, 2] = p[8 * i + 2] - gap * inside * lead
        f[i, 3] = p[8 * i + 3]
        f[i, 4] = 0.0
        f[i, 5] = -p[8 * i + 7]
        f[i, 6] = 0.5 * gap * edge
        f[i, 7] = 0.0
    f[ANGLE, ANGLE] = 1.0
    if abs(motor) < p[COULOMB_MOTOR]:
        add_rest(p, 6, p[REST_MOTOR], f, 1)
    plus, minus = p[RATIO_PLUS], p[RATIO_MINUS]
    if load >= plus * coulomb:
        for i in range(MOVING):
            f[i, 7] += p[8 * i + 7] * plus
    elif load <= -minus * coulomb:
        for i in range(MOVING):
            f[i, 7] -= p[8 * i + 7] * minus
    else:
        add_rest(p, 7, p[REST_LOAD], f, 2)


@njit(cache=True)
def add_rest(p, column, torque, f, speed):
    """The friction that brings ``speed`` to rest follows all that moves it."""
    for j in range(7):
        if j != ANGLE:
            slope = f[speed, j] * torque
            for i in range(MOVING):
                f[i, j] += p[8 * i + column] * slope


@njit(cache=True)
def propagate(p, s, f, work):
    """Covariance a piece of a sample on: F P Fᵀ + Q."""
    c = COVARIANCE
    for i in range(MOVING):
        for j in range(N):
            work[i, j] = (
                f[i, 0] * s[c + j]
                + f[i, 1] * s[c + N + j]
                + f[i, 2] * s[c + 2 * N + j]
                + f[i, 3] * s[c + 3 * N + j]
                + f[i, 4] * s[c + 4 * N + j]
                + f[i, 5] * s[c + 5 * N + j]
                + f[i, 6] * s[c + 6 * N + j]
                + f[i, 7] * s[c + 7 * N + j]
            )
    for i in range(MOVING):
        for j in range(i, MOVING):
            total = 0.0
            for k in range(N):
                total += work[i, k] * f[j, k]
            s[c + i * N + j] = s[c + j * N + i] = total
        for j in range(MOVING, N):
            s[c + i * N + j] = s[c + j * N + i] = work[i, j]
    for i in range(N):
        s[c + i * N + i] += p[PROCESS + i]


@njit(cache=True)
def _predict(p, s, torque, f, work):
    for i in range(4):
        s[BEFORE + i] = s[i]
    for _ in range(int(p[PIECES])):
        z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
        gap, above, below = mean_gap(z, 0.5 * s[BACKLASH], spread(s, p[LEAD_MIDDLE]))
        n0, n1, n2, n3, turn, motor, load = advance(
            p, s[0], s[1], s[2], s[3], s[LOAD_TORQUE], s[COULOMB], gap, torque
        )
        jacobian(p, 1.0 - above - below, above - below, motor, load, s[COULOMB], f)
        propagate(p, s, f, work)
        s[0], s[1], s[2], s[3], s[FRICTION] = n0, n1, n2, n3, load
        s[ANGLE] += turn * p[AVERAGED]


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    f, work = np.empty((MOVING, N)), np.empty((MOVING, N))
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, work)
    recover(p, s)
    write(p, s, work[0], outputs)
    _predict(p, s, torque, f, work)
    recover(p, s)
    return faults

"""Extended Kalman filter with backlash, load torque and Coulomb level as states: one step.

The gap enters by its mean over the estimate's own spread (statistical linearisation), so its slope is the chance of
being inside it and never jumps.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .steppers import INIT, STEP
from .steppers_model import (
    COULOMB_MOTOR,
    LEAD_MIDDLE,
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
    PREVIOUS,
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
def propagate(p, s, f, work):
    """Covariance a sample on: F P Fᵀ + Q."""
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


@njit(cache=True)
def _predict(p, s, torque, f, work):
    z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
    gap, above, below = mean_gap(z, 0.5 * s[BACKLASH], spread(s, p[LEAD_MIDDLE]))
    n0, n1, n2, n3, motor, load = advance(p, s[0], s[1], s[2], s[3], s[LOAD_TORQUE], s[COULOMB], gap, torque)
    jacobian(p, 1.0 - above - below, above - below, motor, load, s[COULOMB], f)
    propagate(p, s, f, work)
    for i in range(4):
        s[BEFORE + i] = s[i]
    s[PREVIOUS] = s[1]
    s[0], s[1], s[2], s[3], s[FRICTION] = n0, n1, n2, n3, load


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    f, work = np.empty((4, N)), np.empty((4, N))
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, work)
    recover(p, s)
    write(p, s, work[0], outputs)
    _predict(p, s, torque, f, work)
    recover(p, s)
    return faults

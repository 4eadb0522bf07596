"""Extended Kalman filter with parameters as states: one step.

The gap enters by its mean over the estimate's own spread (statistical linearisation), so its slope is the chance of
being inside it and never jumps.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from .parameter_tracking import (
    BACKLASH,
    BEFORE,
    COULOMB,
    COVARIANCE,
    EASE_LOAD,
    EASE_MOTOR,
    FACTOR,
    FRICTION,
    LOAD_TORQUE,
    MOVING,
    N,
    approach,
    begin,
    correct_all,
    new_state,
    recover,
    spread,
    write,
)  # fmt: skip
from .runner import INIT, STEP
from .two_mass_model import (
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
    STIFFNESS,
    advance,
    mean_gap,
    shaft_slope,
)  # fmt: skip


@njit(INIT, cache=True)
def init(p):
    return new_state(p)


@njit(cache=True)
def jacobian(p, x, gap_term, inside, edge, change, motor, load, f):
    """f (5, N): derivatives of the moving states and of the angle counted by x; the other rows are constants.

    ``change`` is that of both speeds over the piece.
    """
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
    _adapt(p, x, gap_term, inside, edge, change[0], change[1], f)
    ease = x[EASE_LOAD]
    if abs(motor) < p[COULOMB_MOTOR] * x[EASE_MOTOR]:
        add_rest(p, 6, p[REST_MOTOR], f, 1)
    plus, minus, level = p[RATIO_PLUS], p[RATIO_MINUS], ease * max(x[COULOMB], 0.0)
    if load >= plus * level:
        for i in range(MOVING):
            f[i, 7] += p[8 * i + 7] * plus * ease
    elif load <= -minus * level:
        for i in range(MOVING):
            f[i, 7] -= p[8 * i + 7] * minus * ease
    else:
        add_rest(p, 7, p[REST_LOAD], f, 2)


@njit(cache=True)
def _adapt(p, x, gap_term, inside, edge, motor_change, load_change, f):
    """The columns of the factors of stiffness and inverse inertias, and what these factors change in the others."""
    k, slope, lacking = p[STIFFNESS], shaft_slope(p), x[FACTOR] - 1.0
    torque = k * (x[0] - gap_term) + slope * (x[1] - x[2])
    by_rate = slope - k * inside * p[LEAD_MIDDLE]
    for i in range(MOVING):
        both = p[8 * i + 6] - p[8 * i + 7]
        f[i, 0] += lacking * both * k * (1.0 - inside)
        f[i, 1] += lacking * both * by_rate
        f[i, 2] -= lacking * both * by_rate
        f[i, BACKLASH] -= lacking * both * 0.5 * k * edge
        f[i, FACTOR] = both * torque
        f[i, EASE_MOTOR] = p[8 * i + 6] / p[14] * motor_change / x[EASE_MOTOR]
        f[i, EASE_LOAD] = p[8 * i + 7] / p[23] * load_change / x[EASE_LOAD]
    for j in range(EASE_MOTOR):
        motor = (x[EASE_MOTOR] - 1.0) * (f[1, j] - (1.0 if j == 1 else 0.0)) / p[14]
        load = (x[EASE_LOAD] - 1.0) * (f[2, j] - (1.0 if j == 2 else 0.0)) / p[23]
        for i in range(MOVING):
            f[i, j] += p[8 * i + 6] * motor + p[8 * i + 7] * load


@njit(cache=True)
def add_rest(p, column, torque, f, speed):
    """The friction that brings ``speed`` to rest follows all that moves it."""
    for j in range(N):
        if j not in (ANGLE, COULOMB):
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
                + f[i, 8] * s[c + 8 * N + j]
                + f[i, 9] * s[c + 9 * N + j]
                + f[i, 10] * s[c + 10 * N + j]
            )
    for i in range(MOVING):
        for j in range(i, MOVING):
            s[c + i * N + j] = s[c + j * N + i] = (
                work[i, 0] * f[j, 0]
                + work[i, 1] * f[j, 1]
                + work[i, 2] * f[j, 2]
                + work[i, 3] * f[j, 3]
                + work[i, 4] * f[j, 4]
                + work[i, 5] * f[j, 5]
                + work[i, 6] * f[j, 6]
                + work[i, 7] * f[j, 7]
                + work[i, 8] * f[j, 8]
                + work[i, 9] * f[j, 9]
                + work[i, 10] * f[j, 10]
            )
        for j in range(MOVING, N):
            s[c + i * N + j] = s[c + j * N + i] = work[i, j]
    for i in range(N):
        s[c + i * N + i] += p[PROCESS + i]


@njit(cache=True)
def _predict(p, s, torque, f, work):
    for i in range(4):
        s[BEFORE + i] = s[i]
    approach(p, s)
    for _ in range(int(p[PIECES])):
        z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
        gap, above, below = mean_gap(z, 0.5 * s[BACKLASH], spread(s, p[LEAD_MIDDLE]))
        n0, n1, n2, n3, turn, motor, load = advance(
            p,
            s[0],
            s[1],
            s[2],
            s[3],
            s[LOAD_TORQUE],
            s[COULOMB],
            gap,
            torque,
            s[FACTOR],
            s[EASE_MOTOR],
            s[EASE_LOAD],
        )
        jacobian(p, s, gap, 1.0 - above - below, above - below, (n1 - s[1], n2 - s[2]), motor, load, f)
        propagate(p, s, f, work)
        s[0], s[1], s[2], s[3], s[FRICTION] = n0, n1, n2, n3, load / s[EASE_LOAD]
        s[ANGLE] += turn * p[AVERAGED]


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    f, work = np.empty((MOVING, N)), np.empty((MOVING, N))
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, work)
    recover(p, s)
    write(p, s, work[0], work[1], outputs)
    _predict(p, s, torque, f, work)
    recover(p, s)
    return faults

"""Unscented Kalman filter with the states of ``steppers_tracking``: one step.

17 points at ±√(n + 1) along the columns of the covariance's Cholesky factor and one in the middle, all of positive
weight (κ = 1; Julier & Uhlmann 2004, Proc. IEEE 92, 401–422).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .steppers import INIT, STEP
from .steppers_model import ANGLE, AVERAGED, LEAD_MIDDLE, PIECES, PROCESS, advance, clip
from .steppers_tracking import (
    BACKLASH,
    BEFORE,
    COULOMB,
    COVARIANCE,
    FRICTION,
    LOAD_TORQUE,
    N,
    begin,
    correct_all,
    new_state,
    recover,
    write,
)  # fmt: skip

POINTS = 2 * N + 1
_WEIGHT = 0.5 / (N + 1.0)
_MIDDLE = 1.0 / (N + 1.0)
_REACH = math.sqrt(N + 1.0)


@njit(INIT, cache=True)
def init(p):
    return new_state(p)


@njit(cache=True)
def _factor(s, root):
    """Lower Cholesky factor of the covariance; a direction without variance gives a column of zeros."""
    for j in range(N):
        pivot = s[COVARIANCE + j * N + j]
        for k in range(j):
            pivot -= root[j, k] * root[j, k]
        regular = pivot > 1e-13 * s[COVARIANCE + j * N + j]
        diagonal = math.sqrt(pivot) if regular else 0.0
        root[j, j] = diagonal
        for i in range(j + 1, N):
            total = s[COVARIANCE + i * N + j]
            for k in range(j):
                total -= root[i, k] * root[j, k]
            root[i, j] = total / diagonal if regular else 0.0


@njit(cache=True)
def _move(p, x, torque):
    """One point a sample later, in place; returns the load's Coulomb torque."""
    half = 0.5 * max(x[BACKLASH], 0.0)
    load = 0.0
    for _ in range(int(p[PIECES])):
        gap = clip(x[0] + p[LEAD_MIDDLE] * (x[1] - x[2]), -half, half)
        n0, n1, n2, n3, turn, _, load = advance(
            p, x[0], x[1], x[2], x[3], x[LOAD_TORQUE], max(x[COULOMB], 0.0), gap, torque
        )
        x[0], x[1], x[2], x[3] = n0, n1, n2, n3
        x[ANGLE] += turn * p[AVERAGED]
    return load


@njit(cache=True)
def _predict(p, s, torque, root, points):
    for i in range(4):
        s[BEFORE + i] = s[i]
    _factor(s, root)
    for i in range(N):
        points[0, i] = s[i]
        for j in range(N):
            offset = _REACH * root[i, j] if j <= i else 0.0
            points[1 + j, i] = s[i] + offset
            points[1 + N + j, i] = s[i] - offset
    s[FRICTION] = _MIDDLE * _move(p, points[0], torque)
    for k in range(1, POINTS):
        s[FRICTION] += _WEIGHT * _move(p, points[k], torque)
    for i in range(N):
        total = _MIDDLE * points[0, i]
        for k in range(1, POINTS):
            total += _WEIGHT * points[k, i]
        s[i] = total
        for k in range(POINTS):
            points[k, i] -= total
    for i in range(N):
        for j in range(i, N):
            total = 0.0
            for k in range(1, POINTS):
                total += points[k, i] * points[k, j]
            total = _MIDDLE * points[0, i] * points[0, j] + _WEIGHT * total
            s[COVARIANCE + i * N + j] = s[COVARIANCE + j * N + i] = total
    for i in range(N):
        s[COVARIANCE + i * N + i] += p[PIECES] * p[PROCESS + i]


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    root, points = np.empty((N, N)), np.empty((POINTS, N))
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, points)
    recover(p, s)
    write(p, s, points[0], outputs)
    _predict(p, s, torque, root, points)
    recover(p, s)
    return faults

"""Unscented Kalman filter with parameters as states: one step (Särkkä 2013, algorithm 5.14).

Two sigma points at ±√(n + 1) along each of the n columns of the covariance's Cholesky factor and one in the middle, all
of positive weight (κ = 1; Julier & Uhlmann 2004, Proc. IEEE 92, 401–422). A direction without variance has no points.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import njit
from .contact import predict_contact
from .layout import (
    ANGLE_COUNTED,
    BACKLASH,
    COULOMB,
    INVERSE_INERTIA_LOAD,
    INVERSE_INERTIA_MOTOR,
    MOVING,
    PARAMETERS,
    SPEED_LOAD,
    SPEED_MOTOR,
    STIFFNESS,
    TORQUE_ACTUATOR,
    TORQUE_LOAD,
    TRACKED,
    TWIST,
    record,
)
from .records import reads, scratch
from .runner import INIT, STEP
from .tracking.correction import measurement_update
from .tracking.start import (
    LARGEST_FACTOR,
    LEAST_FACTOR,
    SIZE,
    before_first_sample,
    keep_before,
    memory_of,
    start_again_if_lost,
)
from .two_mass_model import advance, clip, gap_argument

_parameters = reads(PARAMETERS)
_point = record(("x", (TRACKED,)))
_scratch = scratch(
    record(
        ("H", (TRACKED,)), ("PHt", (TRACKED,)), ("L", (TRACKED, TRACKED)), ("points", _point, 2 * TRACKED + 1)
    )
)  # fmt: skip

#: A pivot below this part of its variance is rounding: that direction has no variance (numerics).
LEAST_PIVOT = 1e-13


@njit(INIT, cache=True)
def init(parameters):
    state = np.zeros(SIZE)
    before_first_sample(_parameters(parameters), memory_of(state))
    return state


@njit(cache=True)
def _cholesky(P, L):
    """Lower factor L of P = L Lᵀ; a direction without variance gives a column of zeros."""
    for j in range(TRACKED):
        pivot = P[j, j]
        for k in range(j):
            pivot -= L[j, k] * L[j, k]
        regular = pivot > LEAST_PIVOT * P[j, j]
        diagonal = math.sqrt(pivot) if regular else 0.0
        inverse = 1.0 / diagonal if regular else 0.0
        L[j, j] = diagonal
        for i in range(j + 1, TRACKED):
            total = P[i, j]
            for k in range(j):
                total -= L[i, k] * L[j, k]
            L[i, j] = total * inverse


@njit(cache=True)
def _sigma_points(x, L, points):
    """The points that the covariance's factor L spans around x; returns how many."""
    n = 0
    for j in range(TRACKED):
        n += L[j, j] > 0.0
        points[0].x[j] = x[j]
    reach = math.sqrt(n + 1.0)
    count = 1
    for j in range(TRACKED):
        if L[j, j] > 0.0:
            for i in range(TRACKED):
                offset = reach * L[i, j] if j <= i else 0.0
                points[count].x[i] = x[i] + offset
                points[count + 1].x[i] = x[i] - offset
            count += 2
    return count


@njit(cache=True)
def _move(p, x, torque):
    """A point a sample on, in place, through the true, sharp gap; returns the load's Coulomb torque."""
    half = 0.5 * max(x[BACKLASH], 0.0)
    stiffness = clip(x[STIFFNESS], LEAST_FACTOR, LARGEST_FACTOR)
    motor = clip(x[INVERSE_INERTIA_MOTOR], LEAST_FACTOR, LARGEST_FACTOR)
    load = clip(x[INVERSE_INERTIA_LOAD], LEAST_FACTOR, LARGEST_FACTOR)
    friction = 0.0
    for _ in range(int(p.substeps)):
        gap = clip(gap_argument(x, p.lead_middle), -half, half)
        n0, n1, n2, n3, turn, _, friction = advance(
            p, x, x[TORQUE_LOAD], max(x[COULOMB], 0.0), gap, torque, stiffness, motor, load
        )
        x[TWIST], x[SPEED_MOTOR], x[SPEED_LOAD], x[TORQUE_ACTUATOR] = n0, n1, n2, n3
        x[ANGLE_COUNTED] += turn * p.counted
    return friction / load


@njit(cache=True)
def _moments(points, count, middle, x, P, products):
    """Mean x and covariance P of the moved points; ``products`` is scratch. Constants keep theirs."""
    weight = 0.5 * middle
    for i in range(MOVING):
        x[i] = middle * points[0].x[i]
    for k in range(1, count):
        for i in range(MOVING):
            x[i] += weight * points[k].x[i]
    for i in range(MOVING):
        for j in range(TRACKED):
            products[i, j] = 0.0
    for k in range(count):
        share, apart = weight if k else middle, points[k].x
        for j in range(TRACKED):
            apart[j] -= x[j]
        for i in range(MOVING):
            part = share * apart[i]
            for j in range(TRACKED):
                products[i, j] += part * apart[j]
    for i in range(MOVING):
        for j in range(i, TRACKED):
            P[i, j] = P[j, i] = products[i, j]


@njit(cache=True)
def _predict(p, s, torque, L, points):
    """x and P a sample on."""
    x, P = s.estimate.x, s.estimate.P
    _cholesky(P, L)
    count = _sigma_points(x, L, points)
    middle = 2.0 / (count + 1.0)
    weight = 0.5 * middle
    s.friction = middle * _move(p, points[0].x, torque)
    for k in range(1, count):
        s.friction += weight * _move(p, points[k].x, torque)
    _moments(points, count, middle, x, P, L)
    for i in range(TRACKED):
        P[i, i] += p.substeps * p.Q[i]


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    p, s, w = _parameters(parameters), memory_of(state), _scratch()
    torque, faults = measurement_update(p, s, inputs, faults, outputs, w.H, w.PHt)
    keep_before(s)
    predict_contact(p, s.estimate.x, s.estimate.P, s.contact)
    _predict(p, s, torque, w.L, w.points)
    start_again_if_lost(p, s)
    return faults

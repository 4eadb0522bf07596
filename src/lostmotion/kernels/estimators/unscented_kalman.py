"""Unscented Kalman filter with the states of ``parameter_tracking``: one step.

Two points at ±√(n + 1) along each of the n columns of the covariance's Cholesky factor and one in the middle, all of
positive weight (κ = 1; Julier & Uhlmann 2004, Proc. IEEE 92, 401–422). A direction without variance has no points.
"""

from __future__ import annotations

import math

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
    LARGEST_FACTOR,
    LEAST_FACTOR,
    LOAD_TORQUE,
    MOVING,
    N,
    approach,
    begin,
    correct_all,
    new_state,
    recover,
    write,
)  # fmt: skip
from .runner import INIT, STEP
from .two_mass_model import ANGLE, AVERAGED, LEAD_MIDDLE, PIECES, PROCESS, advance, clip

POINTS = 2 * N + 1


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
        inverse = 1.0 / diagonal if regular else 0.0
        root[j, j] = diagonal
        for i in range(j + 1, N):
            total = s[COVARIANCE + i * N + j]
            for k in range(j):
                total -= root[i, k] * root[j, k]
            root[i, j] = total * inverse


@njit(cache=True)
def _move(p, points, k, torque):
    """Point k a sample later, in place; returns the load's Coulomb torque. (A view of its row would cost 10 ns.)"""
    half = 0.5 * max(points[k, BACKLASH], 0.0)
    stiffness = clip(points[k, FACTOR], LEAST_FACTOR, LARGEST_FACTOR)
    motor = clip(points[k, EASE_MOTOR], LEAST_FACTOR, LARGEST_FACTOR)
    ease = clip(points[k, EASE_LOAD], LEAST_FACTOR, LARGEST_FACTOR)
    load = 0.0
    for _ in range(int(p[PIECES])):
        gap = clip(points[k, 0] + p[LEAD_MIDDLE] * (points[k, 1] - points[k, 2]), -half, half)
        n0, n1, n2, n3, turn, _, load = advance(
            p,
            points[k, 0],
            points[k, 1],
            points[k, 2],
            points[k, 3],
            points[k, LOAD_TORQUE],
            max(points[k, COULOMB], 0.0),
            gap,
            torque,
            stiffness,
            motor,
            ease,
        )
        points[k, 0], points[k, 1], points[k, 2], points[k, 3] = n0, n1, n2, n3
        points[k, ANGLE] += turn * p[AVERAGED]
    return load / ease


@njit(cache=True)
def _scatter(s, root, points):
    """The points that the covariance's factor spans around the mean; returns how many."""
    n = 0
    for j in range(N):
        n += root[j, j] > 0.0
    reach = math.sqrt(n + 1.0)
    points[0] = s[:N]
    count = 1
    for j in range(N):
        if root[j, j] > 0.0:
            for i in range(N):
                offset = reach * root[i, j] if j <= i else 0.0
                points[count, i] = s[i] + offset
                points[count + 1, i] = s[i] - offset
            count += 2
    return count


@njit(cache=True)
def _gather(s, points, count, middle, products):
    """Mean and covariance of the moved points; ``products`` (N, N) is scratch. Constants keep theirs."""
    weight = 0.5 * middle
    for i in range(MOVING):
        s[i] = middle * points[0, i]
    for k in range(1, count):
        for i in range(MOVING):
            s[i] += weight * points[k, i]
    products[:] = 0.0
    for k in range(count):
        share = weight if k else middle
        for j in range(N):
            points[k, j] -= s[j]
        for i in range(MOVING):
            part = share * points[k, i]
            for j in range(N):
                products[i, j] += part * points[k, j]
    for i in range(MOVING):
        for j in range(i, N):
            s[COVARIANCE + i * N + j] = s[COVARIANCE + j * N + i] = products[i, j]


@njit(cache=True)
def _predict(p, s, torque, root, points):
    for i in range(4):
        s[BEFORE + i] = s[i]
    approach(p, s)
    _factor(s, root)
    count = _scatter(s, root, points)
    middle = 2.0 / (count + 1.0)
    weight = 0.5 * middle
    s[FRICTION] = middle * _move(p, points, 0, torque)
    for k in range(1, count):
        s[FRICTION] += weight * _move(p, points, k, torque)
    _gather(s, points, count, middle, root)
    for i in range(N):
        s[COVARIANCE + i * N + i] += p[PIECES] * p[PROCESS + i]


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    root, points = np.empty((N, N)), np.empty((POINTS, N))
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, points)
    recover(p, s)
    write(p, s, points[0], points[1], outputs)
    _predict(p, s, torque, root, points)
    recover(p, s)
    return faults

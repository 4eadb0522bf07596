"""Innovations of the Kalman observer of a two-mass drivetrain with backlash, for identification.

The same observer as ``observers.kalman`` makes, from parameters to innovations in one call that holds no
interpreter lock: one identification calls it some hundred times. LAPACK is left out, because its threads cost
milliseconds per 8 × 8 matrix on a busy machine.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

#: Terms of the series, and largest norm before squaring: 0.5¹³/13! is below rounding.
_TERMS = 12
_NORM = 0.5

#: Doublings of the Riccati iteration; each doubles the time that it looks back, so this is never reached.
_DOUBLINGS = 60


@njit(cache=True, nogil=True)
def _product(a, b):
    out = np.zeros((a.shape[0], b.shape[1]))
    for i in range(a.shape[0]):
        for k in range(a.shape[1]):
            for j in range(b.shape[1]):
                out[i, j] += a[i, k] * b[k, j]
    return out


@njit(cache=True, nogil=True)
def _inverse(a):
    """Gauss–Jordan with row pivoting."""
    n = a.shape[0]
    work, out = a.copy(), np.eye(n)
    for column in range(n):
        pivot = column
        for row in range(column + 1, n):
            if abs(work[row, column]) > abs(work[pivot, column]):
                pivot = row
        for j in range(n):
            work[column, j], work[pivot, j] = work[pivot, j], work[column, j]
            out[column, j], out[pivot, j] = out[pivot, j], out[column, j]
        scale = 1.0 / work[column, column]
        for j in range(n):
            work[column, j] *= scale
            out[column, j] *= scale
        for row in range(n):
            factor = work[row, column]
            if row != column and factor != 0.0:
                for j in range(n):
                    work[row, j] -= factor * work[column, j]
                    out[row, j] -= factor * out[column, j]
    return out


@njit(cache=True, nogil=True)
def _continuous(parameters):
    """(8, 8) block [A, inputs; 0, 0].

    States: twist, speed_motor, speed_load, torque_actuator. Inputs: torque, gap, friction of motor and load.
    """
    jm, jl, k, d = parameters[:4]
    viscous, viscous_motor, lag = parameters[6], parameters[8], parameters[9]
    block = np.zeros((8, 8))
    block[0, 1], block[0, 2] = 1.0, -1.0
    block[1, 0], block[1, 1], block[1, 2] = -k / jm, -(d + viscous_motor) / jm, d / jm
    block[2, 0], block[2, 1], block[2, 2] = k / jl, d / jl, -(d + viscous) / jl
    if lag > 0.0:
        block[1, 3], block[3, 3], block[3, 4] = 1.0 / jm, -1.0 / lag, 1.0 / lag
    else:
        block[1, 4] = 1.0 / jm
    block[1, 5], block[2, 5] = k / jm, -k / jl
    block[1, 6] = -1.0 / jm
    block[2, 7] = -1.0 / jl
    return block


@njit(cache=True, nogil=True)
def _sampled(block, density, dt):
    """exp(block·dt), and ∫exp(A·s)·density·exp(Aᵀ·s)ds over dt: series over dt/2ⁿ, then n doublings."""
    norm = 0.0
    for i in range(8):
        norm = max(norm, np.sum(np.abs(block[i])) * dt)
    doublings = max(0, math.ceil(math.log2(norm / _NORM)))
    h = dt / 2.0**doublings
    step, term = np.eye(8), np.eye(8)
    a = block[:4, :4].copy()
    noise, slope = np.zeros((4, 4)), density.copy()
    factor = h
    for n in range(1, _TERMS + 1):
        noise += factor * slope
        half = _product(a, slope)
        slope = half + half.T
        factor *= h / (n + 1)
        term = _product(term, block) * (h / n)
        step += term
    for _ in range(doublings):
        phi = step[:4, :4].copy()
        noise = noise + _product(_product(phi, noise), phi.T.copy())
        step = _product(step, step)
    return step, noise


@njit(cache=True, nogil=True)
def _gain(phi, measured, noise, variance):
    """Predictor gain from the discrete Riccati equation, by doubling.

    Source: Anderson 1978, Int. J. Control 28, 295–306.
    """
    n = phi.shape[0]
    a, g, p = phi.T.copy(), np.outer(measured, measured) / variance, noise.copy()
    for _ in range(_DOUBLINGS):
        w = _inverse(np.eye(n) + _product(g, p))
        wa = _product(w, a)
        grown = p + _product(a.T.copy(), _product(p, wa))
        change = np.max(np.abs(grown - p))
        g = g + _product(_product(a, _product(w, g)), a.T.copy())
        a = _product(a, wa)
        p = 0.5 * (grown + grown.T)
        if not change > 1e-15 * np.max(np.abs(p)):
            break
    pc = np.zeros(n)
    for i in range(n):
        pc[i] = np.sum(p[i] * measured)
    gain = np.zeros(n)
    for i in range(n):
        gain[i] = np.sum(phi[i] * pc) / (np.sum(measured * pc) + variance)
    return gain


@njit(cache=True, nogil=True)
def _run(step, gain, c1, c4, lead, half, level_motor, level_load, torque, speed, residual):
    a00, a01, a02, a03, b0, g0, m0, f0 = step[0]
    a10, a11, a12, a13, b1, g1, m1, f1 = step[1]
    a20, a21, a22, a23, b2, g2, m2, f2 = step[2]
    a33, b3 = step[3, 3], step[3, 4]
    k0, k1, k2, k3, k4 = gain
    rest_motor, rest_load = 1.0 / abs(m1), 1.0 / abs(f2)
    x0, x1, x2, x3, x4 = 0.0, speed[0], speed[0], torque[0], speed[0]
    for i in range(torque.size):
        u = torque[i]
        gap = min(max(x0 + lead * (x1 - x2), -half), half)
        n1 = a10 * x0 + a11 * x1 + a12 * x2 + a13 * x3 + b1 * u + g1 * gap
        motor = min(max(n1 * rest_motor, -level_motor), level_motor)
        n2 = a20 * x0 + a21 * x1 + a22 * x2 + a23 * x3 + b2 * u + g2 * gap + m2 * motor
        load = min(max(n2 * rest_load, -level_load), level_load)
        n0 = a00 * x0 + a01 * x1 + a02 * x2 + a03 * x3 + b0 * u + g0 * gap + m0 * motor + f0 * load
        e = speed[i] - c1 * x1 - c4 * x4
        residual[i] = e
        x4 = x1 + k4 * e
        x3 = a33 * x3 + b3 * u + k3 * e
        x0 = n0 + k0 * e
        x1 = n1 + m1 * motor + f1 * load + k1 * e
        x2 = n2 + f2 * load + k2 * e


@njit(cache=True, nogil=True)
def _one(parameters, bandwidth, dt, count_averaged, torque, speed, residual):
    """Innovations for one set of parameters."""
    density = np.zeros((4, 4))
    density[1, 1], density[2, 2] = bandwidth[0] ** 2, bandwidth[1] ** 2
    step, noise4 = _sampled(_continuous(parameters), density, dt)
    phi, noise = np.zeros((5, 5)), np.zeros((5, 5))
    phi[:4, :4], noise[:4, :4] = step[:4, :4], noise4
    phi[4, 1] = 1.0
    c1 = 0.5 if count_averaged else 1.0
    c4 = 1.0 - c1
    gain = _gain(phi, np.array([0.0, c1, 0.0, 0.0, c4]), noise, 1.0 / dt)
    lead = parameters[3] / parameters[2] + 0.5 * dt
    _run(step, gain, c1, c4, lead, 0.5 * parameters[4], parameters[7], parameters[5], torque, speed, residual)


@njit(cache=True, nogil=True)
def innovations(parameters, bandwidth, dt, count_averaged, torque, speed):
    """Innovations y − ŷ of the observer over a recording, (m, n): a row for each row of ``parameters``.

    The states are twist, speed_motor, speed_load, torque_actuator and the speed_motor of the sample before::

        x⁺ = Φ x + Γ (torque, gap, friction_motor, friction_load) + K (y − ŷ)

    The gap is clip(twist + (d/k + dt/2)·rate, ±backlash/2); each friction is the torque that brings its
    inertia to rest at the end of the sample, clipped to the Coulomb level.

    Parameters
    ----------
    parameters : (m, 10) array
        inertia_motor, inertia_load, stiffness, damping, backlash, coulomb, viscous, coulomb_motor,
        viscous_motor, lag; SI units.
    bandwidth : (2,) tuple or array, 1/s
        Roots of the process densities of speed_motor and speed_load, for a density of 1 of the measurement.
    dt : float, s
    count_averaged : bool
        ŷ is the mean of the last two speeds.
    torque, speed : (n,) arrays, Nm and rad/s
    """
    residuals = np.empty((parameters.shape[0], torque.size))
    for i in range(parameters.shape[0]):
        _one(parameters[i], bandwidth, dt, count_averaged, torque, speed, residuals[i])
    return residuals

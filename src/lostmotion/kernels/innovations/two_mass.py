"""Innovations of the Kalman observer of a two-mass drivetrain with backlash, for identification.

The same observer as ``observers.kalman`` makes, from parameters to innovations in one call that holds no
interpreter lock: one identification calls it some hundred times. LAPACK is left out, because its threads cost
milliseconds per 8 × 8 matrix on a busy machine.
"""

from __future__ import annotations

import numpy as np

from ..jit import njit

#: Terms of the series, and largest norm before squaring: 0.5¹³/13! is below rounding (numerics).
_TERMS = 12
#: Numerics, likewise.
_NORM = 0.5

#: Doublings of the Riccati iteration; each doubles the time that it looks back, so this is never reached (numerics).
_DOUBLINGS = 60


@njit(cache=True, nogil=True)
def product(a, b, out):
    """out = a·b; explicit loops compile ten times faster than array expressions.

    Row by row, which makes vector instructions. Zeros of the first factor are skipped, also where the second is
    infinite: a drivetrain's matrices have many.
    """
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = 0.0
        for k in range(b.shape[0]):
            factor = a[i, k]
            if factor != 0.0:
                for j in range(out.shape[1]):
                    out[i, j] += factor * b[k, j]


@njit(cache=True, nogil=True)
def congruence(a, p, work, out, turned):
    """out += a·p·aᵀ, or aᵀ·p·a if ``turned``."""
    n = p.shape[0]
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += (a[k, i] if turned else a[i, k]) * p[k, j]
            work[i, j] = total
    for i in range(n):
        for j in range(n):
            total = 0.0
            for k in range(n):
                total += work[i, k] * (a[k, j] if turned else a[j, k])
            out[i, j] += total


@njit(cache=True, nogil=True)
def solve(a, b):
    """b ← a⁻¹·b by Gauss–Jordan with row pivoting; a is lost."""
    n = a.shape[0]
    for column in range(n):
        pivot = column
        for row in range(column + 1, n):
            if abs(a[row, column]) > abs(a[pivot, column]):
                pivot = row
        for j in range(n):
            a[column, j], a[pivot, j] = a[pivot, j], a[column, j]
        for j in range(b.shape[1]):
            b[column, j], b[pivot, j] = b[pivot, j], b[column, j]
        for row in range(n):
            if row != column:
                factor = a[row, column] / a[column, column]
                for j in range(n):
                    a[row, j] -= factor * a[column, j]
                for j in range(b.shape[1]):
                    b[row, j] -= factor * b[column, j]
    for row in range(n):
        for j in range(b.shape[1]):
            b[row, j] /= a[row, row]


@njit(cache=True, nogil=True)
def continuous(parameters, block):
    """Fill the block [A, inputs; 0, 0].

    States: twist, speed_motor, speed_load, torque_actuator, and whatever else the block has room for. Inputs, its last
    four columns: torque, gap, friction of motor and load.
    """
    u = block.shape[0] - 4
    jm, jl, k, d = parameters[0], parameters[1], parameters[2], parameters[3]
    viscous, viscous_motor, lag = parameters[6], parameters[8], parameters[9]
    block[0, 1], block[0, 2] = 1.0, -1.0
    block[1, 0], block[1, 1], block[1, 2] = -k / jm, -(d + viscous_motor) / jm, d / jm
    block[2, 0], block[2, 1], block[2, 2] = k / jl, d / jl, -(d + viscous) / jl
    if lag > 0.0:
        block[1, 3], block[3, 3], block[3, u] = 1.0 / jm, -1.0 / lag, 1.0 / lag
    else:
        block[1, u] = 1.0 / jm
    block[1, u + 1], block[2, u + 1] = k / jm, -k / jl
    block[1, u + 2], block[2, u + 3] = -1.0 / jm, -1.0 / jl


@njit(cache=True, nogil=True)
def add_series(block, density, half, term, other, h, step, noise):
    """Adds the series of exp(block·h) to step, which begins as the unit matrix like term, and that of the integral of
    ``sampled`` over h to noise; density and the scratch are lost."""
    factor = h
    for order in range(1, _TERMS + 1):
        product(block, density, half)
        product(block, term, other)  # powers of one matrix commute
        for i in range(step.shape[0]):
            for j in range(step.shape[0]):
                term[i, j] = other[i, j] * h / order
                step[i, j] += term[i, j]
        for i in range(density.shape[0]):
            for j in range(density.shape[0]):
                noise[i, j] += factor * density[i, j]
        for i in range(density.shape[0]):
            for j in range(density.shape[0]):
                density[i, j] = half[i, j] + half[j, i]
        factor *= h / (order + 1)


@njit(cache=True, nogil=True)
def sampled(block, density, dt, step, noise):
    """step = exp(block·dt), and the first n rows and columns of noise ∫exp(A·s)·density·exp(Aᵀ·s)ds over dt.

    Series over dt/2ⁿ, then doublings; density (n, n), of the block's first n states, is lost.
    """
    n_block, n = block.shape[0], density.shape[0]
    norm = 0.0
    for i in range(n_block):
        total = 0.0
        for j in range(n_block):
            total += abs(block[i, j]) * dt
        norm = max(norm, total)
    doublings = 0
    while norm > _NORM:
        norm *= 0.5
        doublings += 1
    h = dt / 2.0**doublings
    term, other, half = np.zeros((n_block, n_block)), np.zeros((n_block, n_block)), np.zeros((n, n))
    for i in range(n_block):
        step[i, i] = term[i, i] = 1.0
    add_series(block, density, half, term, other, h, step, noise)
    for _ in range(doublings):
        for i in range(n):
            for j in range(n):
                density[i, j] = noise[i, j]
        # The last argument but one is the target: noise += Φ·noise·Φᵀ with the noise from before.
        congruence(step, density, half, noise, False)
        product(step, step, other)
        for i in range(n_block):
            for j in range(n_block):
                step[i, j] = other[i, j]


@njit(cache=True, nogil=True)
def predictor_gain(phi, c, noise, variances, gain):
    """Predictor gain (n, p) for ŷ = c·x, c (p, n), from the discrete Riccati equation, by doubling.

    Source: Anderson 1978, Int. J. Control 28, 295–306. ``noise`` is lost. No pole needs to be moved that is not seen:
    an unexcited parameter must not stop the fit.
    """
    n, sensors = phi.shape[0], c.shape[0]
    a, g, p = np.zeros((n, n)), np.zeros((n, n)), noise
    both, mixed, work = np.zeros((n, 2 * n)), np.zeros((n, n)), np.zeros((n, n))
    wa, wg = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            a[i, j] = phi[j, i]
            for k in range(sensors):
                g[i, j] += c[k, i] * c[k, j] / variances[k]
    for _ in range(_DOUBLINGS):
        # (I + G P)⁻¹ (A, G)
        product(g, p, mixed)
        for i in range(n):
            mixed[i, i] += 1.0
            for j in range(n):
                both[i, j] = a[i, j]
                both[i, n + j] = g[i, j]
        solve(mixed, both)
        for i in range(n):
            for j in range(n):
                wa[i, j], wg[i, j] = both[i, j], both[i, n + j]
        # G += A (W G) Aᵀ;  P += Aᵀ P W A;  A = A W A
        congruence(a, wg, work, g, False)
        product(p, wa, work)
        change, size = 0.0, 0.0
        for i in range(n):
            for j in range(i + 1):
                total = 0.0
                for k in range(n):
                    total += 0.5 * (a[k, i] * work[k, j] + a[k, j] * work[k, i])
                p[i, j] += total
                p[j, i] = p[i, j]
                change, size = max(change, abs(total)), max(size, abs(p[i, j]))
        product(a, wa, work)
        for i in range(n):
            for j in range(n):
                a[i, j] = work[i, j]
        if not change > 1e-15 * size:
            break
    # K = Φ P Cᵀ (C P Cᵀ + R)⁻¹
    cp, s, turned = np.zeros((sensors, n)), np.zeros((sensors, sensors)), np.zeros((sensors, n))
    product(c, p, cp)
    for i in range(sensors):
        for j in range(sensors):
            for k in range(n):
                s[i, j] += cp[i, k] * c[j, k]
        s[i, i] += variances[i]
        for j in range(n):
            for k in range(n):
                turned[i, j] += cp[i, k] * phi[j, k]
    solve(s, turned)
    for i in range(n):
        for j in range(sensors):
            gain[i, j] = turned[j, i]


@njit(cache=True, nogil=True)
def _run(step, gain, c1, c4, lead, half, level_motor, level_load, torque, speed, residual):
    a00, a01, a02, a03 = step[0, 0], step[0, 1], step[0, 2], step[0, 3]
    a10, a11, a12, a13 = step[1, 0], step[1, 1], step[1, 2], step[1, 3]
    a20, a21, a22, a23 = step[2, 0], step[2, 1], step[2, 2], step[2, 3]
    b0, g0, m0, f0 = step[0, 4], step[0, 5], step[0, 6], step[0, 7]
    b1, g1, m1, f1 = step[1, 4], step[1, 5], step[1, 6], step[1, 7]
    b2, g2, m2, f2 = step[2, 4], step[2, 5], step[2, 6], step[2, 7]
    a33, b3 = step[3, 3], step[3, 4]
    k0, k1, k2, k3, k4 = gain[0, 0], gain[1, 0], gain[2, 0], gain[3, 0], gain[4, 0]
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
def _one(parameters, bandwidth, dt, speed_from_counts, bounds, torque, speed, residual):
    """Innovations for one set of parameters; the observer starts anew with each segment."""
    block, step, density = np.zeros((8, 8)), np.zeros((8, 8)), np.zeros((4, 4))
    phi, noise, gain = np.zeros((5, 5)), np.zeros((5, 5)), np.zeros((5, 1))
    density[1, 1], density[2, 2] = bandwidth[0] ** 2, bandwidth[1] ** 2
    continuous(parameters, block)
    sampled(block, density, dt, step, noise)
    for i in range(4):
        for j in range(4):
            phi[i, j] = step[i, j]
    phi[4, 1] = 1.0
    c1 = 0.5 if speed_from_counts else 1.0
    c4 = 1.0 - c1
    c = np.zeros((1, 5))
    c[0, 1], c[0, 4] = c1, c4
    predictor_gain(phi, c, noise, np.full(1, 1.0 / dt), gain)
    lead = parameters[3] / parameters[2] + 0.5 * dt
    half, motor, load = 0.5 * parameters[4], parameters[7], parameters[5]
    for i in range(bounds.size - 1):
        a, b = bounds[i], bounds[i + 1]
        _run(step, gain, c1, c4, lead, half, motor, load, torque[a:b], speed[a:b], residual[a:b])


@njit(cache=True, nogil=True)
def innovations(parameters, bandwidth, dt, speed_from_counts, bounds, torque, speed):
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
    speed_from_counts : bool
        ŷ is the mean of the last two speeds.
    bounds : (p + 1,) int array
        First row of each of p segments, each with its own start, and the number of rows.
    torque, speed : (n,) arrays, Nm and rad/s
    """
    residuals = np.empty((parameters.shape[0], torque.size))
    for i in range(parameters.shape[0]):
        _one(parameters[i], bandwidth, dt, speed_from_counts, bounds, torque, speed, residuals[i])
    return residuals

"""Innovations of the Kalman observer of a drivetrain with an intermediate inertia on its shaft, for identification.

As ``prediction_error``, whose set-up it shares, with two more states: part of the motor's inertia sits on the shaft,
before the gap. Stiffness and damping are those of the two masses with the same torsional mode.
"""

from __future__ import annotations

import numpy as np

from ..jit import njit
from .two_mass import predictor_gain, sampled

#: Newton's steps at most, and the relative step that is none (numerics).
_STEPS, _CLOSE = 60, 1e-15
#: States: twist behind the intermediate inertia, speed_motor, speed_load, torque_actuator, twist before that inertia,
#: its speed. (Layout.)
_STATES = 6


@njit(cache=True, nogil=True)
def two_springs(inertia_motor, inertia_load, stiffness, share, compliance):
    """Stiffness before and behind the intermediate inertia.

    Their compliances are as ``compliance`` to 1 − ``compliance``; together they give the mode that two masses with
    ``stiffness`` have.

    Parameters
    ----------
    inertia_motor, inertia_load : float, kg m2
        The intermediate inertia belongs to the motor's.
    stiffness : float, Nm/rad
    share : float
        The intermediate inertia's part of the motor's inertia.
    compliance : float
        Part of the shaft's compliance that lies before the intermediate inertia.
    """
    piece = share * inertia_motor
    motor = inertia_motor - piece
    before, behind = 1.0 / compliance, 1.0 / (1.0 - compliance)
    # λ² − sum·λ + product = 0 for the two squared frequencies; the smaller root without cancellation.
    total = before * (1.0 / motor + 1.0 / piece) + behind * (1.0 / piece + 1.0 / inertia_load)
    product = before * behind * (inertia_motor + inertia_load) / (motor * piece * inertia_load)
    squared = 2.0 * product / (total + np.sqrt(total * total - 4.0 * product))
    scale = stiffness * (1.0 / inertia_motor + 1.0 / inertia_load) / squared
    return scale * before, scale * behind


@njit(cache=True, nogil=True)
def lowest_mode(masses, springs):
    """Square of the lowest frequency (rad²/s²) of four inertias (kg m2) in a row with three springs (Nm/rad) between.

    Newton's steps from below the lowest root of the characteristic polynomial of the twists, λ³ − sum·λ² + pairs·λ −
    product, all of whose roots are positive: they cannot step beyond it.
    """
    (first, second, third, fourth), (a, b, c) = masses, springs
    one, two, last = (
        a * (1.0 / first + 1.0 / second),
        b * (1.0 / second + 1.0 / third),
        c * (1.0 / third + 1.0 / fourth),
    )
    near, far = a * b / second**2, b * c / third**2
    total, pairs = one + two + last, one * two + one * last + two * last - near - far
    product = a * b * c * (first + second + third + fourth) / (first * second * third * fourth)
    squared = product / pairs
    for _ in range(_STEPS):
        value = ((squared - total) * squared + pairs) * squared - product
        slope = (3.0 * squared - 2.0 * total) * squared + pairs
        further = squared - value / slope
        if not further > squared * (1.0 + _CLOSE):
            break
        squared = further
    return squared


@njit(cache=True, nogil=True)
def _continuous(parameters, joint, block):
    """Fill the (10, 10) block [A, inputs; 0, 0]; inputs: torque, gap, friction of motor and load."""
    jm, jl = parameters[0], parameters[1]
    viscous, viscous_motor, lag = parameters[6], parameters[8], parameters[9]
    k1, k2 = two_springs(jm, jl, parameters[2], joint[0], joint[1])
    # Damping in proportion to stiffness: damps the torsional mode as the damping of the two masses does.
    rate = parameters[3] / parameters[2]
    d1, d2 = rate * k1, rate * k2
    piece = joint[0] * jm
    jm -= piece
    block[0, 5], block[0, 2] = 1.0, -1.0
    block[1, 4], block[1, 1], block[1, 5] = -k1 / jm, -(d1 + viscous_motor) / jm, d1 / jm
    block[2, 0], block[2, 5], block[2, 2] = k2 / jl, d2 / jl, -(d2 + viscous) / jl
    if lag > 0.0:
        block[1, 3], block[3, 3], block[3, 6] = 1.0 / jm, -1.0 / lag, 1.0 / lag
    else:
        block[1, 6] = 1.0 / jm
    block[4, 1], block[4, 5] = 1.0, -1.0
    block[5, 4], block[5, 1], block[5, 0] = k1 / piece, d1 / piece, -k2 / piece
    block[5, 5], block[5, 2] = -(d1 + d2) / piece, d2 / piece
    block[5, 7], block[2, 7] = k2 / piece, -k2 / jl
    block[1, 8], block[2, 9] = -1.0 / jm, -1.0 / jl


@njit(cache=True, nogil=True)
def _row(step, i):
    """Row i over six states, torque, gap curve, friction of motor and load."""
    return (
        step[i, 0], step[i, 1], step[i, 2], step[i, 3], step[i, 4], step[i, 5],
        step[i, 6], step[i, 7], step[i, 8], step[i, 9],
    )  # fmt: skip


@njit(cache=True, nogil=True)
def _run(step, gain, c1, lead, half, level_motor, level_load, torque, speed, residual):
    a00, a01, a02, a03, a04, a05, b0, g0, m0, f0 = _row(step, 0)
    a10, a11, a12, a13, a14, a15, b1, g1, m1, f1 = _row(step, 1)
    a20, a21, a22, a23, a24, a25, b2, g2, m2, f2 = _row(step, 2)
    a40, a41, a42, a43, a44, a45, b4, g4, m4, f4 = _row(step, 4)
    a50, a51, a52, a53, a54, a55, b5, g5, m5, f5 = _row(step, 5)
    a33, b3 = step[3, 3], step[3, 6]
    k0, k1, k2, k3, k4, k5, k6 = (
        gain[0, 0], gain[1, 0], gain[2, 0], gain[3, 0], gain[4, 0], gain[5, 0], gain[6, 0]
    )  # fmt: skip
    c6 = 1.0 - c1
    rest_motor, rest_load = 1.0 / abs(m1), 1.0 / abs(f2)
    x0, x1, x2, x3, x4, x5, x6 = 0.0, speed[0], speed[0], torque[0], 0.0, speed[0], speed[0]
    for i in range(torque.size):
        u = torque[i]
        gap = min(max(x0 + lead * (x5 - x2), -half), half)
        n0 = a00 * x0 + a01 * x1 + a02 * x2 + a03 * x3 + a04 * x4 + a05 * x5 + b0 * u + g0 * gap
        n1 = a10 * x0 + a11 * x1 + a12 * x2 + a13 * x3 + a14 * x4 + a15 * x5 + b1 * u + g1 * gap
        n2 = a20 * x0 + a21 * x1 + a22 * x2 + a23 * x3 + a24 * x4 + a25 * x5 + b2 * u + g2 * gap
        n4 = a40 * x0 + a41 * x1 + a42 * x2 + a43 * x3 + a44 * x4 + a45 * x5 + b4 * u + g4 * gap
        n5 = a50 * x0 + a51 * x1 + a52 * x2 + a53 * x3 + a54 * x4 + a55 * x5 + b5 * u + g5 * gap
        motor = min(max(n1 * rest_motor, -level_motor), level_motor)
        n2 += m2 * motor
        load = min(max(n2 * rest_load, -level_load), level_load)
        e = speed[i] - c1 * x1 - c6 * x6
        residual[i] = e
        x6 = x1 + k6 * e
        x3 = a33 * x3 + b3 * u + k3 * e
        x0 = n0 + m0 * motor + f0 * load + k0 * e
        x1 = n1 + m1 * motor + f1 * load + k1 * e
        x2 = n2 + f2 * load + k2 * e
        x4 = n4 + m4 * motor + f4 * load + k4 * e
        x5 = n5 + m5 * motor + f5 * load + k5 * e


@njit(cache=True, nogil=True)
def _one(parameters, joint, bandwidth, dt, speed_from_counts, bounds, torque, speed, residual):
    """Innovations for one set of parameters; the observer starts anew with each segment of the recording."""
    n = _STATES
    block, step = np.zeros((n + 4, n + 4)), np.zeros((n + 4, n + 4))
    density, noise, phi = np.zeros((n, n)), np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    density[1, 1] = density[5, 5] = bandwidth[0] ** 2
    density[2, 2] = bandwidth[1] ** 2
    _continuous(parameters, joint, block)
    sampled(block, density, dt, step, noise)
    for i in range(n):
        for j in range(n):
            phi[i, j] = step[i, j]
    phi[n, 1] = 1.0
    c, gain = np.zeros((1, n + 1)), np.zeros((n + 1, 1))
    c1 = 0.5 if speed_from_counts else 1.0
    c[0, 1], c[0, n] = c1, 1.0 - c1
    predictor_gain(phi, c, noise, np.full(1, 1.0 / dt), gain)
    lead = parameters[3] / parameters[2] + 0.5 * dt
    half, motor, load = 0.5 * parameters[4], parameters[7], parameters[5]
    for i in range(bounds.size - 1):
        a, b = bounds[i], bounds[i + 1]
        _run(step, gain, c1, lead, half, motor, load, torque[a:b], speed[a:b], residual[a:b])


@njit(cache=True, nogil=True)
def joint_innovations(parameters, joint, bandwidth, dt, speed_from_counts, bounds, torque, speed):
    """Innovations (m, n), a row for each row of ``parameters``.

    Parameters
    ----------
    joint : (2,) tuple
        ``share`` and ``compliance``, see ``two_springs``.
    parameters, bandwidth, dt, speed_from_counts, bounds, torque, speed
        As for ``prediction_error.innovations``.
    """
    residuals = np.empty((parameters.shape[0], torque.size))
    for i in range(parameters.shape[0]):
        _one(parameters[i], joint, bandwidth, dt, speed_from_counts, bounds, torque, speed, residuals[i])
    return residuals

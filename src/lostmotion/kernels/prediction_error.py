"""Innovations of the Kalman observer of a two-mass drivetrain with backlash, for identification."""

from __future__ import annotations

from numba import njit


@njit(cache=True, nogil=True)
def innovations(phi, torque_gain, curve_gain, gain, measured, lead, limits, rest, state, torque, speed, residual):
    """Run the observer over a recording and write its innovations y − ŷ.

    The states are twist, speed_motor, speed_load, torque_actuator and the speed_motor of the sample before::

        x⁺ = phi x + torque_gain u + curve_gain (gap, friction_motor, friction_load) + gain (y − measured x)

    The gap is clip(twist + lead·rate, ±limits[0]); each friction is the torque that brings its inertia to rest at
    the end of the sample, clipped to ±limits[1] or ±limits[2]. The innovation is left out of that torque. These
    are the sums of ``observers.kalman``, unrolled and five times as fast, because one identification runs them
    some hundred times.

    Parameters
    ----------
    phi : (5, 5) array
        Rows 0 to 3 reach over states 0 to 3; row 4 copies speed_motor.
    torque_gain, gain, measured, state : (5,) arrays
    curve_gain : (5, 3) array
    lead : float, s
    limits : (3,) array
        rad, Nm, Nm.
    rest : (2,) array
        Friction torque per speed that brings motor and load to rest, Nm s/rad.
    torque, speed, residual : (n,) arrays
        Inputs, and the innovations that are written.
    """
    a00, a01, a02, a03 = phi[0, 0], phi[0, 1], phi[0, 2], phi[0, 3]
    a10, a11, a12, a13 = phi[1, 0], phi[1, 1], phi[1, 2], phi[1, 3]
    a20, a21, a22, a23 = phi[2, 0], phi[2, 1], phi[2, 2], phi[2, 3]
    a33, a41 = phi[3, 3], phi[4, 1]
    b0, b1, b2, b3 = torque_gain[0], torque_gain[1], torque_gain[2], torque_gain[3]
    g0, g1, g2 = curve_gain[0, 0], curve_gain[1, 0], curve_gain[2, 0]
    m0, m1, m2 = curve_gain[0, 1], curve_gain[1, 1], curve_gain[2, 1]
    l0, l1, l2 = curve_gain[0, 2], curve_gain[1, 2], curve_gain[2, 2]
    k0, k1, k2, k3, k4 = gain[0], gain[1], gain[2], gain[3], gain[4]
    c1, c4 = measured[1], measured[4]
    half, level_motor, level_load = limits[0], limits[1], limits[2]
    rest_motor, rest_load = rest[0], rest[1]
    x0, x1, x2, x3, x4 = state[0], state[1], state[2], state[3], state[4]
    for i in range(torque.size):
        u = torque[i]
        gap = min(max(x0 + lead * (x1 - x2), -half), half)
        n1 = a10 * x0 + a11 * x1 + a12 * x2 + a13 * x3 + b1 * u + g1 * gap
        motor = min(max(n1 * rest_motor, -level_motor), level_motor)
        n2 = a20 * x0 + a21 * x1 + a22 * x2 + a23 * x3 + b2 * u + g2 * gap + m2 * motor
        load = min(max(n2 * rest_load, -level_load), level_load)
        n0 = a00 * x0 + a01 * x1 + a02 * x2 + a03 * x3 + b0 * u + g0 * gap + m0 * motor + l0 * load
        e = speed[i] - c1 * x1 - c4 * x4
        residual[i] = e
        x4 = a41 * x1 + k4 * e
        x3 = a33 * x3 + b3 * u + k3 * e
        x0 = n0 + k0 * e
        x1 = n1 + m1 * motor + l1 * load + k1 * e
        x2 = n2 + l2 * load + k2 * e

"""Innovations of the Kalman observer with any measured channels and an unknown load torque, for identification.

As ``prediction_error``, whose set-up it shares: from parameters to innovations in one call that holds no interpreter
lock. The loop over the samples works on arrays and takes three times as long as the one for the motor speed alone.
"""

from __future__ import annotations

import numpy as np

from ..jit import njit
from .two_mass import continuous, predictor_gain, sampled

#: Channels by number; the motor speed is always the first column.
SPEED_MOTOR, SPEED_LOAD, TWIST, ANGLE_MOTOR, TORQUE_SHAFT = 0, 1, 2, 3, 4
#: First of the states that are there only where they are needed: motor angle, load torque, then the memory of speeds.
#: (Layout.)
_FURTHER = 4


@njit(cache=True, nogil=True)
def _states(channels, load_torque):
    """Column of the motor angle and of the load torque (−1: none), and the number of model states."""
    n, angle, load = _FURTHER, -1, -1
    for channel in channels:
        if channel == ANGLE_MOTOR:
            angle = n
            n += 1
    if load_torque:
        load = n
        n += 1
    return angle, load, n


@njit(cache=True, nogil=True)
def _rows(channels, averaged, angle, n_model, parameters, c, memory):
    """Measurement rows with the gap closed; memory[i]: state that holds the speed of the sample before, or −1."""
    n = n_model
    for i in range(channels.size):
        memory[i] = -1
        if channels[i] == TWIST:
            c[i, 0] = 1.0
        elif channels[i] == ANGLE_MOTOR:
            c[i, angle] = 1.0
        elif channels[i] == TORQUE_SHAFT:
            c[i, 0], c[i, 1], c[i, 2] = parameters[2], parameters[3], -parameters[3]
        else:
            state = 1 if channels[i] == SPEED_MOTOR else 2
            c[i, state] = 1.0
            if averaged[i]:
                c[i, state] = c[i, n] = 0.5
                memory[i] = n
                n += 1


@njit(cache=True, nogil=True)
def _run(step, gain, c, memory, channels, leads, half, levels, torque, measured, weights, x, residual):
    """One sub-step from the state x on. leads: of the gap curves of the state and of the shaft torque, s."""
    n_model, n, sensors = step.shape[0] - 4, x.size, channels.size
    stiffness, damping = levels[2], levels[3]
    rest_motor, rest_load = 1.0 / abs(step[1, n_model + 2]), 1.0 / abs(step[2, n_model + 3])
    ahead, e = np.zeros(n), np.zeros(sensors)
    for k in range(torque.size):
        rate = x[1] - x[2]
        gap = min(max(x[0] + leads[0] * rate, -half), half)
        for i in range(n_model):
            total = step[i, n_model] * torque[k] + step[i, n_model + 1] * gap
            for j in range(n_model):
                total += step[i, j] * x[j]
            ahead[i] = total
        motor = min(max(ahead[1] * rest_motor, -levels[0]), levels[0])
        load = ahead[2] + step[2, n_model + 2] * motor
        load = min(max(load * rest_load, -levels[1]), levels[1])
        for i in range(n_model):
            ahead[i] += step[i, n_model + 2] * motor + step[i, n_model + 3] * load
        for i in range(sensors):
            if memory[i] >= 0:
                ahead[memory[i]] = x[1] if channels[i] == SPEED_MOTOR else x[2]
        for i in range(sensors):
            if channels[i] == TORQUE_SHAFT:
                z = x[0] + leads[1] * rate
                expected = stiffness * (z - min(max(z, -half), half)) + damping * rate
            else:
                expected = 0.0
                for j in range(n):
                    expected += c[i, j] * x[j]
            e[i] = measured[k, i] - expected
            residual[k, i] = e[i] * weights[i]
        for j in range(n):
            total = ahead[j]
            for i in range(sensors):
                total += gain[j, i] * e[i]
            x[j] = total


@njit(cache=True, nogil=True)
def _start(channels, memory, angle, torque, measured, x):
    """State at the first row of a segment: what is measured, and the motor's speed for the load's."""
    x[:] = 0.0
    x[1] = x[2] = measured[0]
    x[3] = torque
    for i in range(channels.size):
        if channels[i] == SPEED_LOAD:
            x[2] = measured[i]
        elif channels[i] == TWIST:
            x[0] = measured[i]
        elif channels[i] == ANGLE_MOTOR:
            x[angle] = measured[i]
    for i in range(channels.size):
        if memory[i] >= 0:
            x[memory[i]] = measured[i]


@njit(cache=True, nogil=True)
def _one(
    parameters, bandwidth, load_rate, dt, dead_zone, channels, averaged, ratios, bounds, torque, measured, residual
):  # fmt: skip
    """Weighted innovations (n, p) for one set of parameters; the observer starts anew with each segment."""
    angle, load, n_model = _states(channels, load_rate > 0.0)
    n, sensors = n_model, channels.size
    for i in range(sensors):
        n += averaged[i]
    block, step = np.zeros((n_model + 4, n_model + 4)), np.zeros((n_model + 4, n_model + 4))
    density, noise, phi = np.zeros((n_model, n_model)), np.zeros((n, n)), np.zeros((n, n))
    density[1, 1], density[2, 2] = bandwidth[0] ** 2, bandwidth[1] ** 2
    continuous(parameters, block)
    if angle >= 0:
        block[angle, 1] = 1.0
    if load >= 0:
        block[2, load] = 1.0 / parameters[1]
        # A random-walk torque q on an inertia J that is seen by its speed is followed at the rate √(√q/J).
        density[load, load] = ((parameters[0] + parameters[1]) * load_rate**2) ** 2
    sampled(block, density, dt, step, noise)
    c, memory, gain = np.zeros((sensors, n)), np.zeros(sensors, dtype=np.int64), np.zeros((n, sensors))
    _rows(channels, averaged, angle, n_model, parameters, c, memory)
    for i in range(n_model):
        for j in range(n_model):
            phi[i, j] = step[i, j]
    for i in range(sensors):
        if memory[i] >= 0:
            phi[memory[i], 1 if channels[i] == SPEED_MOTOR else 2] = 1.0
    predictor_gain(phi, c, noise, ratios**2 / dt, gain)
    d_over_k = parameters[3] / parameters[2]
    # The dead-zone law damps outside its gap curve.
    leads = (0.5 * dt, 0.0) if dead_zone else (0.5 * dt + d_over_k, d_over_k)
    levels = (parameters[7], parameters[5], parameters[2], parameters[3] if dead_zone else 0.0)
    x = np.zeros(n)
    for i in range(bounds.size - 1):
        a, b = bounds[i], bounds[i + 1]
        _start(channels, memory, angle, torque[a], measured[a], x)
        _run(step, gain, c, memory, channels, leads, 0.5 * parameters[4], levels,
             torque[a:b], measured[a:b], 1.0 / ratios, x, residual[a:b])  # fmt: skip


@njit(cache=True, nogil=True)
def channel_innovations(
    parameters, bandwidth, load_rate, dt, dead_zone, channels, averaged, ratios, bounds, torque, measured
):  # fmt: skip
    """Innovations of all channels over ``ratios``, (m, n, p): a block for each row of ``parameters``.

    Parameters
    ----------
    parameters, bandwidth, dt, bounds, torque
        As for ``prediction_error.innovations``.
    load_rate : float, 1/s
        How fast an unknown load torque is followed; 0: there is none.
    dead_zone : bool
        Contact law of the observer: dead_zone, else viscoelastic.
    channels, averaged : (p,) int arrays
        SPEED_MOTOR first, then others; 1 for a speed that is a mean over the sample before.
    ratios : (p,) array
        Level of each channel's noise over that of the motor speed.
    measured : (n, p) array
    """
    residuals = np.empty((parameters.shape[0], torque.size, channels.size))
    for i in range(parameters.shape[0]):
        _one(
            parameters[i], bandwidth, load_rate, dt, dead_zone, channels, averaged, ratios, bounds, torque, measured,
            residuals[i],
        )  # fmt: skip
    return residuals

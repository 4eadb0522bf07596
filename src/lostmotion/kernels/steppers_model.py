"""What the observers that are steppers share: the two-mass model with gap and friction, sensors, and their checks.

The model is that of ``kernels.prediction_error``; its states here are::

    twist, speed_motor, speed_load, torque_actuator, speed_motor_previous

A step reads its numbers from one flat array, at the places named below. numba's cache does not notice a change in this
file: touch the modules that import it after changing it.
"""

from __future__ import annotations

import math

from numba import njit

# Places in the parameter array.
STEP_MATRIX = 0  # 4 × 8: states × (4 states, torque, gap, friction_motor, friction_load), held over a sample
LEAD_MIDDLE, LEAD = 32, 33  # s: z = twist + lead·rate, at the middle of the sample and at its start
STIFFNESS, DAMPING, VISCOUS, COULOMB_MOTOR = 34, 35, 36, 37
RATIO_PLUS, RATIO_MINUS = 38, 39  # Coulomb level of each direction over their mean
REST_MOTOR, REST_LOAD = 40, 41  # Nm per rad/s that bring an inertia to rest within a sample
MEAN_NOW, MEAN_BEFORE = 42, 43  # the measured speed is this mean of the speed now and a sample ago
TORQUE_BOUND = 44  # Nm: a motor torque beyond it is no torque
GATE, FREEZE, HOLD = 45, 46, 47  # standard deviations, standard deviations, samples
START, START_VARIANCE, PROCESS = 48, 56, 64  # 8 each
KIND, VARIANCE, N_SENSORS = 72, 76, 80  # 4 each: what sensor i measures, variance of a sample
DT = 81
MISMATCH = 82  # standard deviations of the sensor that the model's own error may add to an innovation
COULOMB_BOUND = 83  # Nm: largest Coulomb level that is believed
OWN = 84  # first place that an observer may use for itself

# Kinds of sensors, in the order of ``SENSORS``.
SPEED_MOTOR, SPEED_LOAD, TWIST, TORQUE_SHAFT = 0, 1, 2, 3

#: Places in the memory of one sensor: last value, how often it came in a row, how far the model has moved since,
#: rejections in a row.
MEMORY = 4

#: What to do with a sample: use it; start again from it; predict through all others.
USE, MISSING, START_AGAIN, FROZEN, JUMP = 0, 1, 2, 3, 4

#: An estimate beyond this is lost (SI units; chosen far above any drivetrain), and the observer starts again.
LOST = 1e8

#: Rate at which standard deviations grow while samples are refused as jumps, 1/s, and the speed's largest one, rad/s
#: (chosen: a jump of 8 rad/s is refused for 20 ms).
DOUBT, WORST = 60.0, 10.0

_ROOT_HALF = math.sqrt(0.5)
_DENSITY = 1.0 / math.sqrt(2.0 * math.pi)


@njit(cache=True, inline="always")
def clip(value, low, high):
    return min(max(value, low), high)


@njit(cache=True, inline="always")
def advance(p, x0, x1, x2, x3, load_torque, coulomb, gap, torque):
    """The four moving states after a sample, with the gap term given; then the friction torques.

    Each friction takes what brings its inertia to rest at the end of the sample, within its Coulomb level.
    """
    n0 = p[0] * x0 + p[1] * x1 + p[2] * x2 + p[3] * x3 + p[4] * torque + p[5] * gap - p[7] * load_torque
    n1 = p[8] * x0 + p[9] * x1 + p[10] * x2 + p[11] * x3 + p[12] * torque + p[13] * gap - p[15] * load_torque
    n2 = (
        p[16] * x0 + p[17] * x1 + p[18] * x2 + p[19] * x3 + p[20] * torque + p[21] * gap - p[23] * load_torque
    )
    n3 = p[27] * x3 + p[28] * torque
    motor = clip(n1 * p[REST_MOTOR], -p[COULOMB_MOTOR], p[COULOMB_MOTOR])
    n2 += p[22] * motor
    load = clip(n2 * p[REST_LOAD], -p[RATIO_MINUS] * coulomb, p[RATIO_PLUS] * coulomb)
    n0 += p[6] * motor + p[7] * load
    n1 += p[14] * motor + p[15] * load
    n2 += p[23] * load
    return n0, n1, n2, n3, motor, load


@njit(cache=True, inline="always")
def mean_gap(z, half, deviation):
    """Mean of clip(z, ±half) if z is spread by ``deviation``, and the chances of contact at +half and at −half."""
    if deviation * 6.0 < min(abs(z - half), abs(z + half)) or deviation <= 0.0:
        if z > half:
            return half, 1.0, 0.0
        if z < -half:
            return -half, 0.0, 1.0
        return z, 0.0, 0.0
    above = (z - half) / deviation
    below = (-z - half) / deviation
    chance_above = 0.5 * math.erfc(-above * _ROOT_HALF)
    chance_below = 0.5 * math.erfc(-below * _ROOT_HALF)
    excess = deviation * (above * chance_above + _DENSITY * math.exp(-0.5 * above * above))
    lack = deviation * (below * chance_below + _DENSITY * math.exp(-0.5 * below * below))
    return z - excess + lack, chance_above, chance_below


@njit(cache=True, inline="always")
def torque_of(p, x0, x1, x2, gap):
    """Shaft torque, with gap = clip(twist + lead·rate, ±half)."""
    return p[STIFFNESS] * (x0 - gap) + p[DAMPING] * (x1 - x2)


@njit(cache=True, inline="always")
def write_estimates(p, x0, x1, x2, half, coulomb_torque, outputs):
    """The six outputs that every observer has."""
    z = x0 + p[LEAD] * (x1 - x2)
    outputs[0] = x0
    outputs[1] = x0 - clip(x0, -half, half)
    outputs[2] = x1
    outputs[3] = x2
    outputs[4] = torque_of(p, x0, x1, x2, clip(z, -half, half))
    outputs[5] = coulomb_torque + p[VISCOUS] * x2


@njit(cache=True, inline="always")
def torque_believed(p, state, at, inputs, faults):
    """The motor torque to use and the faults: beyond the bound the last believed one, kept at ``state[at]``."""
    torque = inputs[0]
    if abs(torque) <= p[TORQUE_BOUND]:
        state[at] = torque
    else:
        faults |= 1
    return state[at], faults


@njit(cache=True, inline="always")
def sensor_believed(p, state, at, value, missing, moved, innovation, variance, deviation):
    """Whether a sample of a sensor is used; keeps the sensor's memory at ``state[at]``.

    Missing samples are not. A frozen one is not: the very same value again, while the model alone has moved by more
    than ``FREEZE`` deviations since it came first. A jump is not: an innovation beyond ``GATE`` times its own
    deviation plus ``MISMATCH`` times the sensor's; but after ``HOLD`` rejected samples in a row the signal counts as
    right and the estimate as lost.

    Parameters
    ----------
    moved : float
        Change of the predicted signal over the last sample by the model alone.
    deviation : float
        Standard deviation of the sensor.

    Returns
    -------
    int
        USE, MISSING, FROZEN, JUMP (predict through these) or START_AGAIN.
    """
    if missing:
        state[at + 2] += moved
        return MISSING
    if value == state[at]:
        state[at + 1] += 1.0
        state[at + 2] += moved
        if state[at + 1] >= 3.0 and abs(state[at + 2]) > p[FREEZE] * deviation:
            return FROZEN
    else:
        state[at] = value
        state[at + 1] = 1.0
        state[at + 2] = 0.0
    if abs(innovation) <= p[GATE] * math.sqrt(variance) + p[MISMATCH] * deviation:
        state[at + 3] = 0.0
        return USE
    state[at + 3] += 1.0
    if state[at + 3] > p[HOLD]:
        state[at + 3] = 0.0
        return START_AGAIN
    return JUMP


@njit(cache=True)
def doubt(s, at, n, first, growth):
    """Standard deviations of the first states of the (n, n) covariance at s[at …] grow by a factor, up to WORST.

    So an estimate that was surer than it should be, after a drop-out say, believes its sensor again within
    milliseconds.
    """
    if s[at + n + 1] > WORST * WORST:
        return
    for i in range(first):
        for j in range(n):
            s[at + i * n + j] *= growth
            s[at + j * n + i] *= growth

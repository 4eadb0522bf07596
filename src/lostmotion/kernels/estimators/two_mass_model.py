"""What the observers that are steppers share: the two-mass model with gap and friction, sensors, and their checks.

The model is that of ``kernels.innovations.two_mass``; its states here are::

    twist, speed_motor, speed_load, torque_actuator, angle_counted

``angle_counted`` is the angle that the motor has turned since the angle that its encoder last counted. A speed from
count differences, times the sample time, measures this state, and the error of one count is white in it: in the speed
itself it comes twice, with opposite signs, and nearly cancels. Without such a sensor the state stays zero.

A long sample is predicted in several equal pieces, so that the gap term is held for a short time only.

A step reads its numbers from one flat array, at the places named below. numba's cache does not notice a change in this
file: touch the modules that import it after changing it.
"""

from __future__ import annotations

import math

from numba import njit

# Places in the parameter array.
STEP_MATRIX = (
    0  # 5 × 8: states × (4 states, torque, gap, friction_motor, friction_load), over a piece; row 4: turn
)
LEAD_MIDDLE, LEAD = 40, 41  # s: z = twist + lead·rate, at the middle of the piece and at its start
STIFFNESS, DAMPING, VISCOUS, COULOMB_MOTOR = 42, 43, 44, 45
RATIO_PLUS, RATIO_MINUS = 46, 47  # Coulomb level of each direction over their mean
REST_MOTOR, REST_LOAD = 48, 49  # Nm per rad/s that bring an inertia to rest within a piece
PIECES = 50  # of a sample
AVERAGED = 51  # 1 if the measured motor speed comes from counts
TORQUE_BOUND = 52  # Nm: a motor torque beyond it is no torque
GATE, HOLD, DT = 53, 54, 55  # standard deviations, samples, s
START, START_VARIANCE, PROCESS = 56, 67, 78  # 11 each; PROCESS for a piece
KIND, SCALE, VARIANCE, MISMATCH, STILL = 89, 93, 97, 101, 105  # 4 each, see ``sensor_believed``
N_SENSORS = 109
COULOMB_BOUND = 110  # Nm: largest Coulomb level that is believed
FROZEN_HOLD = 111  # samples
INERTIA_MOTOR, INERTIA_LOAD = 112, 113
MODE_SHARE, MODE_RATE = 114, 115  # see ``by_modes``
MISSING_TORQUE, WORST, BLIND_TWIST = 116, 117, 118  # see ``observers.filters.tuning``
OWN = 119  # first place that an observer may use for itself

# Kinds of sensors, in the order of ``SENSORS``.
SPEED_MOTOR, SPEED_LOAD, TWIST, TORQUE_SHAFT = 0, 1, 2, 3

#: Places in the memory of one sensor: last value, how often it came in a row, how far the model has moved since,
#: rejections in a row, and the smallest step that the value ever made (0 if none).
MEMORY = 5

#: What to do with a sample: use it; start again from it; predict through all others.
USE, MISSING, START_AGAIN, FROZEN, JUMP = 0, 1, 2, 3, 4

#: An estimate beyond this is lost (SI units; chosen far above any drivetrain), and the observer starts again.
LOST = 1e8

#: Place of ``angle_counted`` among the states.
ANGLE = 4

#: Rate at which standard deviations grow while samples are refused as jumps, 1/s (chosen).
DOUBT = 60.0

#: A value stands still if the model has moved by less than so many of its smallest steps (chosen: ``tuning.FREEZE``
#: deviations of a count); smaller changes than this share of a value are its rounding.
STEPS, ROUNDING = 2.45, 1e-9

_ROOT_HALF = math.sqrt(0.5)
_ROOT_SIXTH = math.sqrt(1.0 / 6.0)
_DENSITY = 1.0 / math.sqrt(2.0 * math.pi)


@njit(cache=True, inline="always")
def clip(value, low, high):
    return min(max(value, low), high)


@njit(cache=True, inline="always")
def shaft_slope(p):
    """Nm per rad/s of twist rate that the shaft torque gains until the middle of a piece, damping included."""
    return p[DAMPING] + p[STIFFNESS] * (p[LEAD_MIDDLE] - p[LEAD])


@njit(cache=True, inline="always")
def advance(
    p, x0, x1, x2, x3, load_torque, coulomb, gap, torque, stiffness=1.0, motor_ease=1.0, load_ease=1.0
):
    """The four moving states after a piece of a sample, with the gap term given; the motor's turn; the frictions.

    Each friction takes what brings its inertia to rest at the end of the piece, within its Coulomb level.

    ``stiffness`` multiplies the shaft's torque (its damping too), each ``…_ease`` divides an inertia. What they change
    is a torque held over the piece: on both ends the shaft torque of the middle of the piece that the model lacks, on
    an inertia what its change of speed lacks.
    """
    n0 = p[0] * x0 + p[1] * x1 + p[2] * x2 + p[3] * x3 + p[4] * torque + p[5] * gap - p[7] * load_torque
    n1 = p[8] * x0 + p[9] * x1 + p[10] * x2 + p[11] * x3 + p[12] * torque + p[13] * gap - p[15] * load_torque
    n2 = (
        p[16] * x0 + p[17] * x1 + p[18] * x2 + p[19] * x3 + p[20] * torque + p[21] * gap - p[23] * load_torque
    )
    n3 = p[27] * x3 + p[28] * torque
    turn = (
        p[32] * x0 + p[33] * x1 + p[34] * x2 + p[35] * x3 + p[36] * torque + p[37] * gap - p[39] * load_torque
    )
    lacking = (stiffness - 1.0) * (p[STIFFNESS] * (x0 - gap) + shaft_slope(p) * (x1 - x2))
    at_motor = (1.0 - motor_ease) * (n1 + (p[14] - p[15]) * lacking - x1) * p[REST_MOTOR] + lacking
    at_load = (1.0 - load_ease) * (n2 + (p[22] - p[23]) * lacking - x2) * p[REST_LOAD] - lacking
    n0 += p[6] * at_motor + p[7] * at_load
    n1 += p[14] * at_motor + p[15] * at_load
    n2 += p[22] * at_motor + p[23] * at_load
    turn += p[38] * at_motor + p[39] * at_load
    motor = clip(n1 * p[REST_MOTOR], -p[COULOMB_MOTOR] * motor_ease, p[COULOMB_MOTOR] * motor_ease)
    n2 += p[22] * motor
    level = coulomb * load_ease
    load = clip(n2 * p[REST_LOAD], -p[RATIO_MINUS] * level, p[RATIO_PLUS] * level)
    n0 += p[6] * motor + p[7] * load
    n1 += p[14] * motor + p[15] * load
    n2 += p[23] * load
    turn += p[38] * motor + p[39] * load
    return n0, n1, n2, n3, turn, motor, load


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
def by_modes(share, rate, state, at, torque):
    """Variance that modes beyond the model add to the shaft torque: of its own running variance, the share squared.

    What makes them swing is what the torque itself does. Its mean and variance, kept at state[at …], forget by ``rate``
    with each sample.
    """
    away = torque - state[at]
    state[at] += rate * away
    state[at + 1] += rate * (away * away - state[at + 1])
    return share * share * state[at + 1]


@njit(cache=True, inline="always")
def wound(now, before, half):
    """Change of the elastic twist: within the gap none."""
    return now - clip(now, -half, half) - before + clip(before, -half, half)


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
def blind_samples(p, blind, faults):
    """For how many samples no sensor was there, at most ``HOLD``; then back as fast."""
    if faults >> 1 == (1 << int(p[N_SENSORS])) - 1:
        return min(blind + 1.0, p[HOLD])
    return max(blind - 1.0, 0.0)


@njit(cache=True, inline="always")
def doubt_torque(p, s, at, n, missing, blind):
    """What a motor torque that is missing may do to the (n, n) covariance at s[at …] within a sample.

    The motor's speed then follows its sensor. While there is none either, the torque stays as wrong as it is: what
    that does grows with time, not with its root. After a time without sensors nobody knows on which side of the gap
    the joint is, and a filter that linearises the gap once takes each place for it too soon: so the twist wanders for
    as long again.
    """
    if missing:
        s[at + n + 1] += (p[MISSING_TORQUE] * p[DT]) ** 2 * max(blind, 1.0)
    elif blind > 0.0:
        s[at] += (p[BLIND_TWIST] * p[DT]) ** 2 * blind


@njit(cache=True, inline="always")
def sensor_variance(p, state, at, i):
    """Variance of sensor ``i``, times ``SCALE`` squared; at least that of the steps in which its value comes.

    An encoder coarser than was told shows itself by them, in its first few changes.
    """
    step = state[at + 4] * p[SCALE + i]
    return max(p[VARIANCE + i], step * step / 12.0)


@njit(cache=True, inline="always")
def deviation_of_steps(state, at):
    """Standard deviation of a speed that is a difference of counts, by its smallest step."""
    return state[at + 4] * _ROOT_SIXTH


@njit(cache=True, inline="always")
def sensor_believed(p, state, at, i, value, missing, moved, innovation, variance):
    """Whether a sample of sensor ``i`` is used; keeps the sensor's memory at ``state[at]``.

    Missing samples are not. A frozen one is not: the very same value again, while the model alone has moved by more
    than ``STILL`` since it came first, and from then on until it changes. A jump is not: an innovation beyond ``GATE``
    times its own deviation plus what the model's own error may add, ``MISMATCH``. But after ``HOLD`` jumps in a row, or
    a value that came ``FROZEN_HOLD`` times, the signal counts as right and the estimate as lost.

    Parameters
    ----------
    value, moved : float
        The sample, and the change of the predicted signal over the last sample by the model alone, as measured.
    innovation, variance : float
        Times ``SCALE`` and its square: of the angle turned if the speed comes from counts.

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
        state[at + 2] = LOST if state[at + 2] >= LOST else state[at + 2] + moved
        if state[at + 1] >= 3.0 and abs(state[at + 2]) > max(p[STILL + i], STEPS * state[at + 4]):
            # Once frozen it stays so, also where the estimate comes past the value again.
            state[at + 2] = LOST
            if state[at + 1] <= p[FROZEN_HOLD]:
                return FROZEN
            state[at + 1] = state[at + 2] = state[at + 3] = 0.0
            return START_AGAIN
    else:
        step = abs(value - state[at])
        if step > ROUNDING * abs(value) and (step < state[at + 4] or state[at + 4] == 0.0):
            state[at + 4] = step
        state[at] = value
        state[at + 1] = 1.0
        state[at + 2] = 0.0
    if abs(innovation) <= p[GATE] * math.sqrt(variance) + p[MISMATCH + i]:
        state[at + 3] = 0.0
        return USE
    state[at + 3] += 1.0
    if state[at + 3] > p[HOLD]:
        state[at + 3] = 0.0
        return START_AGAIN
    return JUMP


@njit(cache=True, inline="always")
def scalar_update(s, mean, covariance, n, innovation, variance, gain):
    """The mean at s[mean …] and its (n, n) covariance corrected by one sensor; ``gain`` holds P·hᵀ."""
    for i in range(n):
        s[mean + i] += gain[i] / variance * innovation
    for i in range(n):
        for j in range(i, n):
            value = s[covariance + i * n + j] - gain[i] * gain[j] / variance
            s[covariance + i * n + j] = value
            s[covariance + j * n + i] = value


@njit(cache=True, inline="always")
def next_count(p, i, s, mean, covariance, n, value, error, used):
    """After sensor ``i`` counted: the angle of the mean at s[mean …] is measured from the newest count on.

    A used sample moves it by what was counted. Otherwise the count is not known: the angle is then its error alone, and
    in the (n, n) covariance at s[covariance …] it is white noise of the variance ``error``.
    """
    if used:
        s[mean + ANGLE] -= value * p[SCALE + i]
        return
    s[mean + ANGLE] = 0.0
    for j in range(n):
        s[covariance + ANGLE * n + j] = s[covariance + j * n + ANGLE] = 0.0
    s[covariance + ANGLE * (n + 1)] = error


@njit(cache=True)
def doubt(p, s, at, n, first, growth):
    """Standard deviations of the first states of the (n, n) covariance at s[at …] grow by a factor, up to ``p[WORST]``.

    So an estimate that was surer than it should be, after a drop-out say, believes its sensor again within
    milliseconds.
    """
    if s[at + n + 1] > p[WORST] * p[WORST]:
        return
    for i in range(first):
        for j in range(n):
            s[at + i * n + j] *= growth
            s[at + j * n + i] *= growth

"""What the filters that track parameters share: start, correction, outputs.

States: those of ``two_mass_model``, then torque_load, backlash, coulomb, stiffness, ease of motor and load. The
last three are factors: of the shaft's torque and of the inverse inertias. See there for numba's cache.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .two_mass_model import (
    ANGLE,
    AVERAGED,
    COULOMB_BOUND,
    DAMPING,
    DOUBT,
    DT,
    FROZEN,
    INERTIA_LOAD,
    INERTIA_MOTOR,
    JUMP,
    KIND,
    LEAD,
    LEAD_MIDDLE,
    LOST,
    MEMORY,
    MODE_RATE,
    MODE_SHARE,
    N_SENSORS,
    PIECES,
    SCALE,
    SPEED_LOAD,
    SPEED_MOTOR,
    START,
    START_AGAIN,
    START_VARIANCE,
    STIFFNESS,
    TORQUE_SHAFT,
    TWIST,
    USE,
    blind_samples,
    by_modes,
    clip,
    doubt,
    doubt_torque,
    mean_gap,
    next_count,
    scalar_update,
    sensor_believed,
    sensor_variance,
    torque_believed,
    wound,
    write_estimates,
)  # fmt: skip

N = 11
#: The first states move, the last ones are constants that wander.
MOVING = 5
ACTUATOR, LOAD_TORQUE, BACKLASH, COULOMB, FACTOR, EASE_MOTOR, EASE_LOAD = 3, 5, 6, 7, 8, 9, 10

#: Stiffness and inverse inertias stay within these factors of what was told (chosen), so that no input can make
#: the model meaningless.
LEAST_FACTOR, LARGEST_FACTOR = 0.5, 2.0

# Places in the state.
COVARIANCE = N
STARTED = N + N * N
TORQUE = STARTED + 1
FRICTION = STARTED + 2
BEFORE = STARTED + 3  # the four moving states before the last prediction: what the model alone has moved
SENSOR_MEMORY = STARTED + 7
TORQUE_SPREAD = SENSOR_MEMORY + 4 * MEMORY  # see ``by_modes``
BLIND = TORQUE_SPREAD + 2  # see ``two_mass_model.blind_samples``
# A touch that may be none, see ``approach``: what it should pull, the variances before it, its odds, its impulse.
PULL = BLIND + 1
WIDE, WIDE_SPEED, ODDS, IMPULSE = PULL + 1, PULL + 2, PULL + 3, PULL + 4
SIZE = IMPULSE + 1

#: A touch is taken back where the speed says so with these odds (a logarithm), of which one sample gives at most
#: MOST_ODDS (both chosen on a stiff shaft with a wide gap, under excitations of their own).
ODDS_AGAINST, MOST_ODDS = 2.0, 2.0
#: Only where a touch within the spread before it turns the motor by this part of an innovation's deviation within a
#: sample (chosen: there 0.9 to 2.6; at most 0.2 where a filter that linearises once keeps hold).
LEAST_EFFECT = 0.5


@njit(cache=True)
def restart(p, s, speed, count):
    """Both inertias at ``speed``; of the rest, the first ``count`` states as known beforehand."""
    for i in range(count):
        s[i] = p[START + i]
        for j in range(N):
            s[COVARIANCE + i * N + j] = s[COVARIANCE + j * N + i] = 0.0
        s[COVARIANCE + i * N + i] = p[START_VARIANCE + i]
    s[1] = s[2] = speed
    s[ACTUATOR] = s[TORQUE]
    for i in range(4):
        s[BEFORE + i] = s[i]
    s[FRICTION] = s[PULL] = s[WIDE] = s[WIDE_SPEED] = s[ODDS] = s[IMPULSE] = 0.0
    s[STARTED] = 1.0


@njit(cache=True)
def new_state(p):
    state = np.zeros(SIZE)
    restart(p, state, 0.0, N)
    state[STARTED] = 0.0
    return state


@njit(cache=True)
def spread(s, lead):
    """Standard deviation of twist + lead·rate against the edge of the gap."""
    c = COVARIANCE
    p00, p01, p02 = s[c], s[c + 1], s[c + 2]
    p11, p12, p22 = s[c + N + 1], s[c + N + 2], s[c + 2 * N + 2]
    variance = p00 + 2.0 * lead * (p01 - p02) + lead * lead * (p11 - 2.0 * p12 + p22)
    variance += 0.25 * s[c + BACKLASH * N + BACKLASH]
    return math.sqrt(max(variance, 0.0))


@njit(cache=True)
def row(p, s, kind, h):
    """Predicted sensor value (from counts: of the angle turned); its row over the states goes to h."""
    for i in range(N):
        h[i] = 0.0
    if kind == SPEED_MOTOR:
        state = ANGLE if p[AVERAGED] else 1
        h[state] = 1.0
        return s[state]
    if kind == SPEED_LOAD:
        h[2] = 1.0
        return s[2]
    if kind == TWIST:
        h[0] = 1.0
        return s[0]
    k, d, lead = p[STIFFNESS] * s[FACTOR], p[DAMPING] * s[FACTOR], p[LEAD]
    gap, above, below = mean_gap(s[0] + lead * (s[1] - s[2]), 0.5 * s[BACKLASH], spread(s, lead))
    inside = 1.0 - above - below
    h[0] = k * (1.0 - inside)
    h[1] = d - k * lead * inside
    h[2] = -h[1]
    h[BACKLASH] = -0.5 * k * (above - below)
    h[FACTOR] = p[STIFFNESS] * (s[0] - gap) + p[DAMPING] * (s[1] - s[2])
    return h[FACTOR] * s[FACTOR]


@njit(cache=True)
def along(s, h, gain):
    """Variance h·P·hᵀ; P·hᵀ goes to ``gain``. Most entries of a row are zero."""
    gain[:] = 0.0
    for k in range(N):
        if h[k] != 0.0:
            for j in range(N):
                gain[j] += s[COVARIANCE + k * N + j] * h[k]
    variance = 0.0
    for j in range(N):
        variance += h[j] * gain[j]
    return variance


@njit(cache=True)
def correct(s, innovation, variance, gain):
    """Scalar update; ``gain`` holds P·hᵀ on entry."""
    scalar_update(s, 0, COVARIANCE, N, innovation, variance, gain)


@njit(cache=True)
def bound(p, s):
    """Parameters stay where the model has a meaning."""
    s[BACKLASH] = clip(s[BACKLASH], 0.0, 20.0 * p[START + BACKLASH])
    s[COULOMB] = clip(s[COULOMB], 0.0, p[COULOMB_BOUND])
    s[FACTOR] = clip(s[FACTOR], LEAST_FACTOR, LARGEST_FACTOR)
    s[EASE_MOTOR] = clip(s[EASE_MOTOR], LEAST_FACTOR, LARGEST_FACTOR)
    s[EASE_LOAD] = clip(s[EASE_LOAD], LEAST_FACTOR, LARGEST_FACTOR)


@njit(cache=True)
def moved(p, s, kind):
    """Change of a predicted signal over the last sample by the model alone."""
    if kind == SPEED_MOTOR:
        return s[1] - s[BEFORE + 1]
    if kind == SPEED_LOAD:
        return s[2] - s[BEFORE + 2]
    if kind == TWIST:
        return s[0] - s[BEFORE]
    return p[STIFFNESS] * wound(s[0], s[BEFORE], 0.5 * s[BACKLASH])


@njit(cache=True)
def lost(s):
    for i in range(N):  # noqa: SIM110 — numba knows no any()
        if not abs(s[i]) < LOST or not s[COVARIANCE + i * (N + 1)] < LOST * LOST:
            return True
    return False


@njit(cache=True)
def write(p, s, h, scratch, outputs):
    """All outputs; ``h`` and ``scratch`` (N,) are overwritten."""
    c = COVARIANCE
    row(p, s, TORQUE_SHAFT, h)
    write_estimates(p, s[0], s[1], s[2], 0.5 * s[BACKLASH], s[FRICTION], outputs)
    outputs[4] *= s[FACTOR]
    motor, load = p[INERTIA_MOTOR] / s[EASE_MOTOR], p[INERTIA_LOAD] / s[EASE_LOAD]
    outputs[6], outputs[7], outputs[8] = s[LOAD_TORQUE], s[BACKLASH], s[COULOMB]
    outputs[9], outputs[10], outputs[11] = p[STIFFNESS] * s[FACTOR], motor, load
    for i in range(3):
        outputs[12 + i] = math.sqrt(max(s[c + i * (N + 1)], 0.0))
    modes = by_modes(p[MODE_SHARE], p[MODE_RATE], s, TORQUE_SPREAD, outputs[4])
    outputs[15] = math.sqrt(max(along(s, h, scratch), 0.0) + modes)
    for i in range(6):
        outputs[16 + i] = math.sqrt(max(s[c + (5 + i) * (N + 1)], 0.0))
    outputs[19] *= p[STIFFNESS]
    outputs[20] *= motor / s[EASE_MOTOR]
    outputs[21] *= load / s[EASE_LOAD]


@njit(cache=True)
def approach(p, s):
    """Before a prediction: the torque that it expects of a touch, and how wide the estimate was before that touch.

    While the shaft comes near an edge and nothing happens, a filter that linearises grows sure of itself too soon.
    """
    lead = p[LEAD_MIDDLE] + 0.5 * (p[PIECES] - 1.0) / p[PIECES] * p[DT]
    z, c = s[0] + lead * (s[1] - s[2]), COVARIANCE
    side = 1.0 if z >= 0.0 else -1.0
    beyond = side * z - 0.5 * s[BACKLASH]
    by_backlash = s[c + BACKLASH] + lead * (s[c + N + BACKLASH] - s[c + 2 * N + BACKLASH])
    variance = spread(s, lead) ** 2 - side * by_backlash
    speed = s[c + 2 * N + 2]
    if beyond < 0.0 and beyond * beyond > 4.0 * variance:
        s[WIDE], s[WIDE_SPEED] = variance, speed
    else:
        s[WIDE], s[WIDE_SPEED] = max(variance, s[WIDE]), max(speed, s[WIDE_SPEED])
    s[PULL] = p[STIFFNESS] * s[FACTOR] * side * beyond if beyond > 0.0 else 0.0


@njit(cache=True)
def judge_touch(p, s, innovation, variance):
    """Takes a touch back if the motor's speed goes on as if there were none.

    The odds add up sample by sample and never fall below even (Page 1954, Biometrika 41, 100–115). Then the shaft is in
    the gap again, as far from the edge and as uncertain as before, and the load has not got the touch's impulse.
    """
    gain = p[DT] * s[EASE_MOTOR] / p[INERTIA_MOTOR] * (0.5 * p[DT] if p[AVERAGED] else 1.0)
    reach = p[STIFFNESS] * s[FACTOR] * gain
    if s[PULL] == 0.0 or reach * reach * s[WIDE] < LEAST_EFFECT * LEAST_EFFECT * variance:
        s[ODDS] = s[IMPULSE] = 0.0
        return
    effect = s[PULL] * gain
    s[ODDS] += min(effect * (innovation - 0.5 * effect) / variance, MOST_ODDS)
    s[IMPULSE] += s[PULL] * p[DT]
    if s[ODDS] < 0.0:
        s[ODDS] = s[IMPULSE] = 0.0
    elif s[ODDS] > ODDS_AGAINST:
        s[2] -= s[IMPULSE] * s[EASE_LOAD] / p[INERTIA_LOAD]
        free = max(0.5 * s[BACKLASH] - math.sqrt(s[WIDE]), 0.0)
        s[0] = free if s[PULL] > 0.0 else -free
        s[COVARIANCE] += s[WIDE]
        s[COVARIANCE + 2 * N + 2] += s[WIDE_SPEED]
        s[ODDS] = s[IMPULSE] = 0.0


@njit(cache=True)
def correct_all(p, s, inputs, torque_faults, work):
    """Every sensor in turn: believed ones correct the estimate; returns the faults."""
    h, gain = work[0], work[1]
    faults = torque_faults
    for i in range(int(p[N_SENSORS])):
        kind = int(p[KIND + i])
        innovation = inputs[1 + i] * p[SCALE + i] - row(p, s, kind, h)
        error = sensor_variance(p, s, SENSOR_MEMORY + MEMORY * i, i)
        variance = error + along(s, h, gain)
        verdict = sensor_believed(
            p, s, SENSOR_MEMORY + MEMORY * i, i, inputs[1 + i], torque_faults & (2 << i) != 0, moved(p, s, kind),
            innovation, variance,
        )  # fmt: skip
        if verdict == USE:
            correct(s, innovation, variance, gain)
            bound(p, s)
        else:
            faults |= 2 << i
        if kind == SPEED_MOTOR and verdict in (USE, JUMP):
            judge_touch(p, s, innovation, variance)
        if verdict in (FROZEN, JUMP):
            doubt(p, s, COVARIANCE, N, LOAD_TORQUE, math.exp(DOUBT * p[DT]))
        if verdict == START_AGAIN:
            restart(p, s, inputs[1 + i] if kind <= SPEED_LOAD else s[1], LOAD_TORQUE)
        if kind == SPEED_MOTOR and p[AVERAGED]:
            next_count(p, i, s, 0, COVARIANCE, N, inputs[1 + i], error, verdict == USE)
    return faults


@njit(cache=True)
def begin(p, s, inputs, faults):
    """The torque to use and the faults; a first sample starts the filter."""
    torque, faults = torque_believed(p, s, TORQUE, inputs, faults)
    s[BLIND] = blind_samples(p, s[BLIND], faults)
    doubt_torque(p, s, COVARIANCE, N, faults & 1 != 0, s[BLIND])
    if s[STARTED] == 0.0:
        restart(p, s, inputs[1] if int(p[KIND]) == SPEED_MOTOR and faults & 2 == 0 else 0.0, N)
    return torque, faults


@njit(cache=True)
def recover(p, s):
    """Start again if the estimate is lost."""
    if lost(s):
        restart(p, s, 0.0, N)
        s[STARTED] = s[TORQUE_SPREAD] = s[TORQUE_SPREAD + 1] = 0.0

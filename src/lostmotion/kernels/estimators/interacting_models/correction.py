"""Interacting models: what the sensors say of every model, and what all models say together."""

from __future__ import annotations

import math

from numba import njit

from ..two_mass_model import (
    ANGLE,
    AVERAGED,
    COULOMB_BOUND,
    DAMPING,
    DOUBT,
    DT,
    FROZEN,
    JUMP,
    KIND,
    LEAD,
    MEMORY,
    MODE_RATE,
    MODE_SHARE,
    SCALE,
    SPEED_LOAD,
    SPEED_MOTOR,
    START_AGAIN,
    STIFFNESS,
    TWIST,
    USE,
    by_modes,
    clip,
    doubt,
    next_count,
    scalar_update,
    sensor_believed,
    sensor_variance,
    wound,
    write_estimates,
)  # fmt: skip
from .state import (
    BEFORE,
    CHANCE,
    COULOMB,
    FRICTION,
    HALF,
    LOAD_TORQUE,
    MODELS,
    ONE,
    SENSOR_MEMORY,
    SHARE,
    TORQUE_SPREAD,
    N,
    restart,
)  # fmt: skip


@njit(cache=True)
def _row(p, s, m, kind, h):
    """Predicted sensor value of model m (from counts: of the angle turned); its row over the states goes to h."""
    at = m * ONE
    for i in range(N):
        h[i] = 0.0
    if kind == SPEED_MOTOR:
        state = ANGLE if p[AVERAGED] else 1
        h[state] = 1.0
        return s[at + state]
    if kind == SPEED_LOAD:
        h[2] = 1.0
        return s[at + 2]
    if kind == TWIST:
        h[0] = 1.0
        return s[at]
    return _torque(p, s, m, h)


@njit(cache=True)
def _torque(p, s, m, h):
    """Shaft torque of model m; its row goes to h[0 … 2]."""
    at, k = m * ONE, p[STIFFNESS]
    closed = m != 1
    h[0] = k if closed else 0.0
    h[1] = p[DAMPING] - (0.0 if closed else k * p[LEAD])
    h[2] = -h[1]
    edge = (1 - m) * p[HALF]
    return h[0] * (s[at] - edge) + h[1] * (s[at + 1] - s[at + 2])


@njit(cache=True)
def _likeliest(s):
    best = 0
    for m in range(MODELS):
        if s[CHANCE + m] > s[CHANCE + best]:
            best = m
    return best


@njit(cache=True)
def _sudden(p, s, innovation):
    """How much further a torque is off what all models expect than a shaft can wind within a sample.

    One of three models expects nearly any torque. But the shaft, touching or not, winds by no more than its ends turn
    against each other; twice that is believed.
    """
    rate, away = 0.0, 0.0
    for m in range(MODELS):
        rate += s[CHANCE + m] * (s[m * ONE + 1] - s[m * ONE + 2])
        away += s[CHANCE + m] * innovation[m]
    return abs(away) - 2.0 * p[STIFFNESS] * p[DT] * abs(rate)


@njit(cache=True)
def sensor(p, s, i, value, missing, h, gain, innovation, variance):
    """One sensor in all models; returns whether it was not believed.

    Scratch: h, gain (≥ 3, N); innovation, variance (≥ 3,).
    """
    kind = int(p[KIND + i])
    best, error = 0, sensor_variance(p, s, SENSOR_MEMORY + MEMORY * i, i)
    for m in range(MODELS):
        innovation[m] = value * p[SCALE + i] - _row(p, s, m, kind, h[m])
        variance[m] = error
        for j in range(N):
            gain[m, j] = 0.0
        for k in range(N):
            if h[m, k] != 0.0:  # few are not
                for j in range(N):
                    gain[m, j] += s[m * ONE + N + k * N + j] * h[m, k]
        for j in range(N):
            variance[m] += h[m, j] * gain[m, j]
        if innovation[m] * innovation[m] * variance[best] < innovation[best] * innovation[best] * variance[m]:
            best = m
    moved = 0.0
    column = 1 if kind == SPEED_MOTOR else 2 if kind == SPEED_LOAD else 0
    for m in range(MODELS):
        moved += s[CHANCE + m] * s[m * ONE + column]
    away, spread = innovation[best], variance[best]
    if kind > TWIST:
        moved = p[STIFFNESS] * wound(moved, s[BEFORE], p[HALF])
        sudden, own = _sudden(p, s, innovation), variance[_likeliest(s)]
        if sudden > 0.0 and sudden * sudden * spread > away * away * own:
            away, spread = sudden, own
    else:
        moved -= s[BEFORE + column]
    verdict = sensor_believed(p, s, SENSOR_MEMORY + MEMORY * i, i, value, missing, moved, away, spread)
    if verdict in (FROZEN, JUMP):
        for m in range(MODELS):
            doubt(p, s, m * ONE + N, N, LOAD_TORQUE, math.exp(DOUBT * p[DT]))
    if verdict == START_AGAIN:
        restart(p, s, value if kind <= SPEED_LOAD else s[ONE + 1], LOAD_TORQUE)
    if verdict == USE:
        _weigh(p, s, h, innovation, variance, gain)
    if kind == SPEED_MOTOR and p[AVERAGED]:
        for m in range(MODELS):
            next_count(p, i, s, m * ONE, m * ONE + N, N, value, error, verdict == USE)
    return verdict != USE


@njit(cache=True)
def _weigh(p, s, h, innovation, variance, gain):
    """Every model corrected, and its chance by how likely the sample was."""
    total = 0.0
    for m in range(MODELS):
        # Student's t with three degrees of freedom instead of Gauss: a mode that no model has must not decide; and of
        # it the share of a sample, since errors of samples close to each other are alike.
        tail = 1.0 + innovation[m] * innovation[m] / (3.0 * variance[m])
        s[CHANCE + m] *= (tail * tail * math.sqrt(variance[m])) ** -p[SHARE]
        total += s[CHANCE + m]
        scalar_update(s, m * ONE, m * ONE + N, N, innovation[m], variance[m], gain[m])
        s[m * ONE + COULOMB] = clip(s[m * ONE + COULOMB], 0.0, p[COULOMB_BOUND])
    for m in range(MODELS):
        s[CHANCE + m] /= total


@njit(cache=True)
def write(p, s, h, work, outputs):
    """All outputs: the mixture's means and standard deviations."""
    mean, second = work[0], work[1]
    for i in range(N):
        mean[i] = second[i] = 0.0
        for m in range(MODELS):
            mean[i] += s[CHANCE + m] * s[m * ONE + i]
        for m in range(MODELS):
            apart = s[m * ONE + i] - mean[i]
            second[i] += s[CHANCE + m] * (s[m * ONE + N + i * N + i] + apart * apart)
    write_estimates(p, mean[0], mean[1], mean[2], p[HALF], s[FRICTION], outputs)
    torque, square = 0.0, 0.0
    for m in range(MODELS):
        one = _torque(p, s, m, h)
        variance, c = 0.0, m * ONE + N
        for j in range(3):
            for k in range(3):
                variance += h[j] * h[k] * s[c + j * N + k]
        torque += s[CHANCE + m] * one
        square += s[CHANCE + m] * (one * one + variance)
    outputs[4] = torque
    outputs[6], outputs[7] = mean[LOAD_TORQUE], mean[COULOMB]
    for m in range(MODELS):
        outputs[8 + m] = s[CHANCE + m]
    for i in range(3):
        outputs[11 + i] = math.sqrt(max(second[i], 0.0))
        s[BEFORE + i] = mean[i]
    modes = by_modes(p[MODE_SHARE], p[MODE_RATE], s, TORQUE_SPREAD, torque)
    outputs[14] = math.sqrt(max(square - torque * torque, 0.0) + modes)
    outputs[15] = math.sqrt(max(second[LOAD_TORQUE], 0.0))
    outputs[16] = math.sqrt(max(second[COULOMB], 0.0))

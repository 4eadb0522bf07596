"""Interacting models: correction of every model by the sensors, their probabilities, the outputs of the mixture."""

from __future__ import annotations

import math

from ...jit import njit
from ..kalman import correct, inflate, variance_along
from ..layout import (
    MODEL_COULOMB,
    MODEL_STATES,
    MODELS,
    SPEED_LOAD,
    SPEED_MOTOR,
    TORQUE_LOAD,
    TWIST,
)
from ..sensor_check import REFUSED_RATE, check_sample
from ..sensors import (
    OF_SPEED_LOAD,
    OF_SPEED_MOTOR,
    OF_TORQUE_SHAFT,
    count_from_here,
    sensor_variance,
    state_measured,
    state_shown,
)
from ..two_mass_model import clip, eigenmode_variance, elastic_change, write_estimates
from ..verdicts import FROZEN, JUMP, START_AGAIN, USE
from .mixing import likeliest_model
from .state import IN_GAP, edge, restart


@njit(cache=True)
def _predicted(own, x, m, kind, H):
    """h(x): what a sensor should show by model m (from counts: the angle turned); the row ∂h/∂x goes to H."""
    for i in range(MODEL_STATES):
        H[i] = 0.0
    if kind == OF_TORQUE_SHAFT:
        return _shaft_torque(own, x, m, H)
    state = state_measured(own.common, kind)
    H[state] = 1.0
    return x[state]


@njit(cache=True)
def _shaft_torque(own, x, m, H):
    """Shaft torque by model m; its derivatives go to H[0 … 2]."""
    p = own.common
    H[TWIST] = 0.0 if m == IN_GAP else p.stiffness
    H[SPEED_MOTOR] = p.damping - (p.stiffness * p.lead if m == IN_GAP else 0.0)
    H[SPEED_LOAD] = -H[SPEED_MOTOR]
    return H[TWIST] * (x[TWIST] - edge(own, m)) + H[SPEED_MOTOR] * (x[SPEED_MOTOR] - x[SPEED_LOAD])


@njit(cache=True)
def _sudden(own, s, nu):
    """By how much the innovation of all models exceeds what a shaft can wind within a sample.

    One of three models predicts nearly any torque. But the shaft, in contact or not, winds by no more than its ends
    turn against each other; twice that is accepted.
    """
    rate, away = 0.0, 0.0
    for m in range(MODELS):
        x = s.models[m].x
        rate += s.probability[m] * (x[SPEED_MOTOR] - x[SPEED_LOAD])
        away += s.probability[m] * nu[m]
    return abs(away) - 2.0 * own.common.stiffness * own.common.dt * abs(rate)


@njit(cache=True)
def _moved_by_models(own, s, kind):
    """Change of a predicted signal over the last sample by the models alone."""
    state = state_shown(kind)
    now = 0.0
    for m in range(MODELS):
        now += s.probability[m] * s.models[m].x[state]
    if kind == OF_TORQUE_SHAFT:
        return own.common.stiffness * elastic_change(now, s.before[state], own.half_gap)
    return now - s.before[state]


@njit(cache=True)
def correct_by_sensor(own, s, i, value, missing, w):
    """Sensor i in all models; returns whether its sample was not used. Scratch: H, PHt, nu, S of each model."""
    p, nu, S = own.common, w.nu, w.S
    kind = int(p.kind[i])
    best, R = 0, sensor_variance(p, i, s.sensors[i])
    for m in range(MODELS):
        x, P = s.models[m].x, s.models[m].P
        nu[m] = value * p.scale[i] - _predicted(own, x, m, kind, w.H)
        S[m] = R + variance_along(P, w.H, w.PHt[m])
        if nu[m] * nu[m] * S[best] < nu[best] * nu[best] * S[m]:
            best = m
    moved = _moved_by_models(own, s, kind)
    away, variance = nu[best], S[best]
    if kind == OF_TORQUE_SHAFT:
        sudden, likeliest = _sudden(own, s, nu), S[likeliest_model(s)]
        if sudden > 0.0 and sudden * sudden * variance > away * away * likeliest:
            away, variance = sudden, likeliest
    verdict = check_sample(p, i, s.sensors[i], value, missing, moved, away, variance)
    if verdict in (FROZEN, JUMP):
        for m in range(MODELS):
            inflate(s.models[m].P, TORQUE_LOAD, math.exp(REFUSED_RATE * p.dt), p.largest_deviation)
    if verdict == START_AGAIN:
        restart(own, s, value if kind <= OF_SPEED_LOAD else s.models[IN_GAP].x[SPEED_MOTOR], TORQUE_LOAD)
    if verdict == USE:
        _correct_models(own, s, w)
    if kind == OF_SPEED_MOTOR and p.counted:
        for m in range(MODELS):
            count_from_here(s.models[m].x, s.models[m].P, value * p.scale[i], R, verdict == USE)
    return verdict != USE


@njit(cache=True)
def _correct_models(own, s, w):
    """Every model corrected, and its probability by how likely the sample was."""
    total = 0.0
    for m in range(MODELS):
        # Student's t with three degrees of freedom instead of Gauss: an eigenmode that no model has must not decide;
        # and of it the share of a sample, since errors of samples close to each other are alike.
        tail = 1.0 + w.nu[m] * w.nu[m] / (3.0 * w.S[m])
        s.probability[m] *= (tail * tail * math.sqrt(w.S[m])) ** -own.likelihood_share
        total += s.probability[m]
        x = s.models[m].x
        correct(x, s.models[m].P, w.PHt[m], w.nu[m], w.S[m])
        x[MODEL_COULOMB] = clip(x[MODEL_COULOMB], 0.0, own.common.coulomb_bound)
    for m in range(MODELS):
        s.probability[m] /= total


@njit(cache=True)
def write(own, s, H, mean, variance, outputs):
    """All outputs: the mixture's means and standard deviations; ``H``, ``mean``, ``variance`` are scratch."""
    p = own.common
    for i in range(MODEL_STATES):
        mean[i] = variance[i] = 0.0
        for m in range(MODELS):
            mean[i] += s.probability[m] * s.models[m].x[i]
        for m in range(MODELS):
            apart = s.models[m].x[i] - mean[i]
            variance[i] += s.probability[m] * (s.models[m].P[i, i] + apart * apart)
    write_estimates(p, mean, own.half_gap, s.friction, outputs)
    torque, square = 0.0, 0.0
    for m in range(MODELS):
        one, P, of_one = _shaft_torque(own, s.models[m].x, m, H), s.models[m].P, 0.0
        for j in range(3):
            for k in range(3):
                of_one += H[j] * H[k] * P[j, k]
        torque += s.probability[m] * one
        square += s.probability[m] * (one * one + of_one)
    outputs[4] = torque
    outputs[6], outputs[7] = mean[TORQUE_LOAD], mean[MODEL_COULOMB]
    for m in range(MODELS):
        outputs[8 + m] = s.probability[m]
    for i in range(3):
        outputs[11 + i] = math.sqrt(max(variance[i], 0.0))
        s.before[i] = mean[i]
    eigenmodes = eigenmode_variance(p.eigenmode_share, p.eigenmode_rate, s.torque_moments, torque)
    outputs[14] = math.sqrt(max(square - torque * torque, 0.0) + eigenmodes)
    outputs[15] = math.sqrt(max(variance[TORQUE_LOAD], 0.0))
    outputs[16] = math.sqrt(max(variance[MODEL_COULOMB], 0.0))

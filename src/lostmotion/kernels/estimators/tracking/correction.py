"""Correction by the sensors, one after the other: what each should show, whether its sample is used, the outputs."""

from __future__ import annotations

import math

from ...jit import njit
from ..contact import cancel_contact, edge_deviation, mean_gap
from ..kalman import correct, inflate, variance_along
from ..layout import (
    BACKLASH,
    COULOMB,
    INVERSE_INERTIA_LOAD,
    INVERSE_INERTIA_MOTOR,
    MOVING,
    SPEED_LOAD,
    SPEED_MOTOR,
    STIFFNESS,
    TORQUE_LOAD,
    TRACKED,
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
from ..two_mass_model import (
    eigenmode_variance,
    elastic_change,
    gap_argument,
    shaft_torque,
    write_estimates,
)
from ..verdicts import FROZEN, JUMP, START_AGAIN, USE
from .start import begin, bound, restart, start_again_if_lost


@njit(cache=True)
def predicted(p, x, P, kind, H):
    """h(x): what a sensor should show (from counts: the angle turned); the row ∂h/∂x goes to H."""
    for i in range(TRACKED):
        H[i] = 0.0
    if kind != OF_TORQUE_SHAFT:
        state = state_measured(p, kind)
        H[state] = 1.0
        return x[state]
    k, d, lead = p.stiffness * x[STIFFNESS], p.damping * x[STIFFNESS], p.lead
    gap, above, below = mean_gap(gap_argument(x, lead), 0.5 * x[BACKLASH], edge_deviation(P, lead))
    inside = 1.0 - above - below
    H[TWIST] = k * (1.0 - inside)
    H[SPEED_MOTOR] = d - k * lead * inside
    H[SPEED_LOAD] = -H[SPEED_MOTOR]
    H[BACKLASH] = -0.5 * k * (above - below)
    H[STIFFNESS] = shaft_torque(p, x, gap)
    return H[STIFFNESS] * x[STIFFNESS]


@njit(cache=True)
def innovation_of(p, memory, x, P, i, value, H, PHt):
    """ν = y − h(x) of sensor i, its variance S = H P Hᵀ + R, and R; H and P Hᵀ go to ``H`` and ``PHt``."""
    nu = value * p.scale[i] - predicted(p, x, P, int(p.kind[i]), H)
    R = sensor_variance(p, i, memory)
    return nu, R + variance_along(P, H, PHt), R


@njit(cache=True)
def check(p, s, i, value, missing, nu, S):
    """Verdict on the sample of sensor i."""
    moved = moved_by_model(p, s, int(p.kind[i]))
    return check_sample(p, i, s.sensors[i], value, missing, moved, nu, S)


@njit(cache=True)
def moved_by_model(p, s, kind):
    """Change of a predicted signal over the last sample by the model alone."""
    state, half = state_shown(kind), 0.5 * s.estimate.x[BACKLASH]
    now, before = s.estimate.x[state], s.before[state]
    if kind == OF_TORQUE_SHAFT:
        return p.stiffness * elastic_change(now, before, half)
    return now - before


@njit(cache=True)
def correct_all(p, s, inputs, given, H, PHt):
    """Every sensor in turn: samples that are used correct the estimate; returns the faults."""
    x, P = s.estimate.x, s.estimate.P
    faults = given
    for i in range(int(p.sensors)):
        kind, value = int(p.kind[i]), inputs[1 + i]
        nu, S, R = innovation_of(p, s.sensors[i], x, P, i, value, H, PHt)
        verdict = check(p, s, i, value, given & (2 << i) != 0, nu, S)
        if verdict == USE:
            correct(x, P, PHt, nu, S)
            bound(p, x)
        else:
            faults |= 2 << i
        if kind == OF_SPEED_MOTOR and verdict in (USE, JUMP):
            cancel_contact(p, x, P, s.contact, nu, S)
        if verdict in (FROZEN, JUMP):
            inflate(P, TORQUE_LOAD, math.exp(REFUSED_RATE * p.dt), p.largest_deviation)
        if verdict == START_AGAIN:
            restart(p, s, value if kind <= OF_SPEED_LOAD else x[SPEED_MOTOR], TORQUE_LOAD)
        if kind == OF_SPEED_MOTOR and p.counted:
            count_from_here(x, P, value * p.scale[i], R, verdict == USE)
    return faults


@njit(cache=True)
def write(p, s, H, PHt, outputs):
    """All outputs."""
    x, P = s.estimate.x, s.estimate.P
    predicted(p, x, P, OF_TORQUE_SHAFT, H)
    write_estimates(p, x, 0.5 * x[BACKLASH], s.friction, outputs)
    outputs[4] *= x[STIFFNESS]
    motor, load = p.inertia_motor / x[INVERSE_INERTIA_MOTOR], p.inertia_load / x[INVERSE_INERTIA_LOAD]
    outputs[6], outputs[7], outputs[8] = x[TORQUE_LOAD], x[BACKLASH], x[COULOMB]
    outputs[9], outputs[10], outputs[11] = p.stiffness * x[STIFFNESS], motor, load
    for i in range(3):
        outputs[12 + i] = math.sqrt(max(P[i, i], 0.0))
    eigenmodes = eigenmode_variance(p.eigenmode_share, p.eigenmode_rate, s.torque_moments, outputs[4])
    outputs[15] = math.sqrt(max(variance_along(P, H, PHt), 0.0) + eigenmodes)
    for i in range(TRACKED - MOVING):
        outputs[16 + i] = math.sqrt(max(P[MOVING + i, MOVING + i], 0.0))
    outputs[19] *= p.stiffness
    outputs[20] *= motor / x[INVERSE_INERTIA_MOTOR]
    outputs[21] *= load / x[INVERSE_INERTIA_LOAD]


@njit(cache=True)
def measurement_update(p, s, inputs, faults, outputs, H, PHt):
    """The estimate of this sample, by all its sensors, and the outputs; returns the torque to use and the faults."""
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, H, PHt)
    start_again_if_lost(p, s)
    write(p, s, H, PHt, outputs)
    return torque, faults

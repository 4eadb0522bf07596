"""Interacting models: the start of all models, and what brings them back once one is lost.

States of a model: those of ``two_mass_model``, then torque_load, coulomb. The models are contact at the upper edge of
the gap, gap, contact at the lower edge; their edges lie at (1 − m)·half.
"""

from __future__ import annotations

from ...jit import njit
from ..layout import (
    INTERACTING,
    INTERACTING_PARAMETERS,
    MODEL_STATES,
    MODELS,
    SPEED_LOAD,
    SPEED_MOTOR,
    TORQUE_ACTUATOR,
    TWIST,
)
from ..records import reads
from ..sensor_check import LOST

parameters_of, memory_of = reads(INTERACTING_PARAMETERS), reads(INTERACTING)

#: Which of the models is the gap (layout).
IN_GAP = 1


@njit(cache=True, inline="always")
def edge(own, m):
    """The gap term of contact in model m; the middle for the gap itself."""
    return (1 - m) * own.half_gap


@njit(cache=True)
def restart(own, s, speed, states):
    """Every model at its edge, both inertias at ``speed``; of the rest, the first ``states`` as at the start."""
    p = own.common
    for m in range(MODELS):
        x, P = s.models[m].x, s.models[m].P
        for i in range(states):
            x[i] = p.x0[i]
            for j in range(MODEL_STATES):
                P[i, j] = P[j, i] = 0.0
            P[i, i] = p.P0[i]
        x[TWIST] = edge(own, m)
        x[SPEED_MOTOR] = x[SPEED_LOAD] = speed
        x[TORQUE_ACTUATOR] = s.torque
        s.probability[m] = 1.0 / MODELS
    for i in range(3):
        s.before[i] = s.models[IN_GAP].x[i]
    s.friction = 0.0
    s.started = 1.0


@njit(cache=True)
def start_again_if_lost(own, s):
    """Start again if an estimate is no number of this drivetrain."""
    for m in range(MODELS):
        x, P = s.models[m].x, s.models[m].P
        lost = not s.probability[m] <= 1.0 + 1e-9
        for i in range(MODEL_STATES):
            lost = lost or not abs(x[i]) < LOST or not P[i, i] < LOST * LOST
        if lost:
            restart(own, s, 0.0, MODEL_STATES)
            s.started = s.torque_moments.mean = s.torque_moments.variance = 0.0
            return

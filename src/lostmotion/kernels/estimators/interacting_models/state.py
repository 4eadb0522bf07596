"""Interacting models: where each number lives in the state, the start of all models, and what brings them back.

States of a model: those of ``two_mass_model``, then torque_load, coulomb. The models are contact at the upper edge of
the gap, gap, contact at the lower edge; their edges lie at (1 − m)·half.
"""

from __future__ import annotations

from numba import njit

from ..two_mass_model import LOST, MEMORY, OWN, START, START_VARIANCE

N, MODELS = 7, 3
#: The first states move, the last two are constants that wander.
MOVING = 5
LOAD_TORQUE, COULOMB = 5, 6
ONE = N + N * N  # a model: its mean, then its covariance

# Own parameters: half of the backlash; chance, within a piece of a sample, that a model begins anew; share of the
# likelihood that counts; the gap's own process variance of the twist.
HALF, ANEW, SHARE, GAP_PROCESS = OWN, OWN + 1, OWN + 2, OWN + 3

# Places in the state.
CHANCE = MODELS * ONE
STARTED = CHANCE + MODELS
TORQUE = STARTED + 1
FRICTION = STARTED + 2
BEFORE = STARTED + 3
SENSOR_MEMORY = STARTED + 6
TORQUE_SPREAD = SENSOR_MEMORY + 4 * MEMORY  # see ``two_mass_model.by_modes``
BLIND = TORQUE_SPREAD + 2  # see ``two_mass_model.blind_samples``
SIZE = BLIND + 1


@njit(cache=True)
def restart(p, s, speed, count):
    """Every model at its edge, both inertias at ``speed``; of the rest, the first ``count`` states as at the start."""
    for m in range(MODELS):
        at = m * ONE
        for i in range(count):
            s[at + i] = p[START + i]
            for j in range(N):
                s[at + N + i * N + j] = s[at + N + j * N + i] = 0.0
            s[at + N + i * N + i] = p[START_VARIANCE + i]
        s[at] = (1 - m) * p[HALF]
        s[at + 1] = s[at + 2] = speed
        s[at + 3] = s[TORQUE]
        s[CHANCE + m] = 1.0 / MODELS
    for i in range(3):
        s[BEFORE + i] = s[ONE + i]
    s[FRICTION] = 0.0
    s[STARTED] = 1.0


@njit(cache=True)
def recover(p, s):
    """Start again if an estimate is lost."""
    for m in range(MODELS):
        at = m * ONE
        bad = not s[CHANCE + m] <= 1.0 + 1e-9
        for i in range(N):
            bad = bad or not abs(s[at + i]) < LOST or not s[at + N + i * N + i] < LOST * LOST
        if bad:
            restart(p, s, 0.0, N)
            s[STARTED] = s[TORQUE_SPREAD] = s[TORQUE_SPREAD + 1] = 0.0
            return

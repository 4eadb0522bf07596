"""Motor or load at rest over whole samples: their transitions, and whether friction holds them, for the
contact-switching filter."""

from __future__ import annotations

import numpy as np

from ..jit import njit
from .columns import COMPILED, INNER, NONE, WIDE
from .sample_parts import parts
from .sensitivities import fill_changes
from .transitions import (
    BLOCK,
    EDGE,
    MOTOR,
    OF_MOTOR,
    TORQUE,
    fill_changed_model,
    fill_continuous,
    fill_transitions,
    layout,
)

#: An inertia counts as at rest if friction stops what is left of its speed within this part of a sample (numerics: so
#: short a way is none).
_AT_ONCE = 1.0 / 16.0


@njit(**COMPILED)
def fill_resting(
    parameters, changed, free, dt, law, finest, kind, level, stuck, numbers, step, models, changes
):
    """Fill the transitions in which what is stuck rests all the while, of the model and of those with a changed
    parameter, and their changes; see ``transitions`` and ``sensitivities``."""
    fill_transitions(parameters, dt, law, finest, kind, level, stuck, models[0], np.zeros(0))
    for j in range(free.size):
        fill_changed_model(free[j], changed[j], dt, law, finest, kind, level, stuck, models, j + 1)
    fill_changes(models, numbers, parts(finest) * BLOCK, step, changes, np.zeros(free.size, dtype=np.int64))


@njit(**COMPILED)
def fill_loads(q, dt, law, kind, loads):
    """Fill the torque that friction must hold on motor and load, Nm per unit of each state and input, and its change
    over a sample: loads[stuck − 1, closed, end, 0 or 1, column of a transition].

    The change is without that of the torque and without the friction of what slides: of its difference between both
    ends of a sample neither is part.
    """
    _, behind, drifts, _, angled = kind
    places = layout(q, angled, behind, drifts)
    n = places[7]
    free, block = np.zeros((n + 4, n + 4)), np.zeros((n + 4, n + 4))
    for closed in range(2):
        fill_continuous(q, dt, places, behind, closed == 1, law, NONE, free)
        for stuck in range(1, 4):
            fill_continuous(q, dt, places, behind, closed == 1, law, stuck, block)
            for end in range(2):
                own, per_torque = loads[stuck - 1, closed, end], -free[1 + end, n + 2 + end]
                for i in range(n):
                    own[0, i] = free[1 + end, i] / per_torque
                own[0, TORQUE] = free[1 + end, n] / per_torque
                own[0, EDGE] = free[1 + end, n + 1] / per_torque
                for i in range(n):
                    for j in range(n):
                        own[1, i] += own[0, j] * block[j, i] * dt
                    own[1, TORQUE] += own[0, i] * block[i, n] * dt
                    own[1, EDGE] += own[0, i] * block[i, n + 1] * dt


@njit(**INNER)
def stops(t, at, c, stuck, x):
    """Whether friction stops at once what is left of the speed of what is stuck; the transition of a whole sample is at
    t[at …]."""
    for end in range(2):
        if stuck & (1 << end):
            change = c[OF_MOTOR + 3 * end] * abs(t[at + (MOTOR + end) * WIDE + 1 + end])
            if abs(x[1 + end]) > _AT_ONCE * change:
                return False
    return True


@njit(forceinline=True, **INNER)
def _load(own, x, torque, edge):
    total = own[TORQUE] * torque + own[EDGE] * edge
    for i in range(WIDE):
        total += own[i] * x[i]
    return total


@njit(**INNER)
def holds(loads, closed, stuck, c, x, first, y, last, edge, share):
    """Whether friction holds all inertias that rest from state x with the torque ``first`` on the motor to state y with
    ``last``, a share of a sample later: the torque on them in between is a parabola of its values and slopes at both
    ends."""
    for end in range(2):
        if stuck & (1 << end):
            own = loads[stuck - 1, closed, end]
            begin, final = _load(own[0], x, first, edge), _load(own[0], y, last, edge)
            bend = share * (_load(own[1], y, last, edge) - _load(own[1], x, first, edge))
            level = c[OF_MOTOR + 3 * end] * (1.0 + c[OF_MOTOR + 3 * end + 1])
            slope = final - begin - 0.5 * bend
            most = max(abs(begin), abs(final))
            if slope * (slope + bend) < 0.0:  # it turns
                most = max(most, abs(begin - 0.5 * slope * slope / bend))
            if most > level:
                return False
    return True

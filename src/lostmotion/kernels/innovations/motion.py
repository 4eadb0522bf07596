"""Motion of two masses, or three, over a sample or a part of it for the contact-switching filter.

Between contacts the model is linear and its transition exact.
"""

from __future__ import annotations

import math

from ..jit import njit
from .columns import INNER, NOTHING, WIDE, add, combine, product_of
from .sliding_friction import friction_slope, mean_friction
from .transitions import (
    CLIPPED,
    EDGE,
    JUMP,
    LIMITED,
    LOAD,
    MOTOR,
    NO_GAP,
    OF_LOAD,
    OF_MOTOR,
    TORQUE,
)

#: Delay after which a contact with spring and damper gives as much as one whose damper gives no more than its spring,
#: over damping/stiffness (physics: at constant speed, u²/2 + u = 1/2).
_LATER = math.sqrt(2.0) - 1.0


@njit(forceinline=True, **INNER)
def moved(t, at, c, of, n, x, torque, jump, edge, stuck, out):
    """State after a sub-step with the transition at t[at …] and a model's numbers at c[of …].

    ``torque``: its mean; ``jump``: by how much it is higher at the beginning, of whole samples; ``stuck``: what rests
    all the while, by the transition. Returns 1 if the motor sticks, plus 2 if the load does.
    """
    motor_at, load_at = at + MOTOR * WIDE, at + LOAD * WIDE
    combine(t, at, n, x, 0, 1, NOTHING, 0, out, 0)
    add(t, at + TORQUE * WIDE, torque, out, 0)
    add(t, at + EDGE * WIDE, edge, out, 0)
    if jump != 0.0:
        add(t, at + JUMP * WIDE, jump, out, 0)
    i, j = of + OF_MOTOR, of + OF_LOAD
    motor, motor_rests, held, load_rests = 0.0, True, 0.0, True
    if not stuck & 1:
        motor, motor_rests = mean_friction(x[1], out[1], t[motor_at + 1], c[i], c[i + 1], c[i + 2])
    if not stuck & 2:
        free = out[2] + t[motor_at + 2] * motor
        held, load_rests = mean_friction(x[2], free, t[load_at + 2], c[j], c[j + 1], c[j + 2])
    add(t, motor_at, motor, out, 0)
    add(t, load_at, held, out, 0)
    # Exactly at rest: rounding is no motion.
    if motor_rests:
        out[1] = 0.0
    if load_rests:
        out[2] = 0.0
    return (1 if motor_rests else 0) + (2 if load_rests else 0)


@njit(**INNER)
def error_transition(t, at, n, stuck, slopes, f, to):
    """Columns of f from f[to] on: how an error of the state goes on over a sub-step, less what sticks.

    ``slopes``: change of the friction of motor and load with the speed.
    """
    for j in range(n):
        for i in range(WIDE):
            f[to + j * WIDE + i] = t[at + j * WIDE + i] if i < n else 0.0
    for which in range(2):
        if slopes[which] != 0.0:
            for i in range(n):
                f[to + (1 + which) * WIDE + i] += slopes[which] * t[at + (MOTOR + which) * WIDE + i]
    for which in range(2):
        if stuck & (1 << which):
            row, column = 1 + which, at + (MOTOR + which) * WIDE
            for j in range(n):
                share = f[to + j * WIDE + row] / t[column + row]
                for i in range(n):
                    f[to + j * WIDE + i] -= share * t[column + i]
                f[to + j * WIDE + row] = 0.0


@njit(**INNER)
def stop_errors(stuck, f):
    """What moves an inertia that rests all the while stops at once."""
    for end in range(2):
        if stuck & (1 << end):
            f[(1 + end) * WIDE : (2 + end) * WIDE] = 0.0


@njit(**INNER)
def follow_errors(t, at, n, resting, stuck, slopes, share, f, work):
    """f = (1 − share)·f + share·(errors over the sub-step)·f; work has room for f and a column. ``resting``: what
    rests by the transition, ``stuck``: what friction has stopped."""
    room = WIDE * WIDE
    if resting == stuck == 0 and slopes[0] == 0.0 and slopes[1] == 0.0 and share == 1.0:
        product_of(t, at, n, f, n, work)
        for j in range(n):
            for i in range(WIDE):
                f[j * WIDE + i] = work[j * WIDE + i]
        return
    error_transition(t, at, n, stuck, slopes, work, 0)
    stop_errors(resting, work)
    for j in range(n):
        combine(work, 0, n, f, j * WIDE, 1, NOTHING, 0, work, room)
        for i in range(WIDE):
            f[j * WIDE + i] += share * (work[room + i] - f[j * WIDE + i])


@njit(forceinline=True, **INNER)
def closing(z, twist, law):
    """What reaches the edge where a contact begins; z is the gap's argument, twist + damping/stiffness · rate.

    Under the clipped law it is the twist. Under the limited law the torque has twice the stiffness and no damper first:
    so much as if it began a little later at once.
    """
    if law == CLIPPED:
        return twist
    if law == LIMITED:
        return twist - _LATER * (z - twist)
    return z


@njit(forceinline=True, **INNER)
def next_contact(contact, z, twist, half, law):
    """Contact after a sub-step (−1, 0, 1); z is the gap's argument."""
    if contact == 0:
        edge = closing(z, twist, law)
        if z > half and edge > half:
            return 1
        if z < -half and edge < -half:
            return -1
        return 0
    return contact if contact * z >= half or law == NO_GAP else 0


@njit(forceinline=True, **INNER)
def reversed_motion(c, of, x, y):
    """Whether an inertia with friction has changed its direction."""
    return (x[2] * y[2] < 0.0 and c[of + OF_LOAD] > 0.0) or (x[1] * y[1] < 0.0 and c[of + OF_MOTOR] > 0.0)


@njit(forceinline=True, **INNER)
def slopes_of_friction(c, of, x, y):
    """Change of the friction of motor and load with the speed, over a sub-step from state x to y."""
    i, j = of + OF_MOTOR, of + OF_LOAD
    return (
        friction_slope(x[1], y[1], c[i], c[i + 1], c[i + 2]),
        friction_slope(x[2], y[2], c[j], c[j + 1], c[j + 2]),
    )

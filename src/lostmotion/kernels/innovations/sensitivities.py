"""How the parameters move the state within a sample in which nothing changes, for the contact-switching filter.

While both inertias slide or rest the state after a sample is linear in the transition's entries, so its change with a
parameter is a product with the transition's change. By differences of whole motions it takes three times as long.
"""

from __future__ import annotations

from ..jit import njit
from .columns import add, combine
from .delayed_torque import delayed
from .gap_in_doubt import mean_gap
from .transitions import (
    BLOCK,
    COMPILED,
    EDGE,
    HALF,
    JUMP,
    LEAD,
    LOAD,
    MOTOR,
    NUMBERS,
    OF_LOAD,
    OF_MOTOR,
    PART,
    TORQUE,
    WIDE,
)

#: What a parameter changes: transitions, torques and friction, the gap (layout).
_TRANSITIONS, _TORQUES, _GAP = 1, 2, 4
#: Columns of a transition that are not a state's, and all (layout).
_INPUTS, COLUMNS = 5, WIDE + 5


@njit(**COMPILED)
def slides(x, y, stuck):
    """Whether motor and load slide or rest all the way from state x to y."""
    return (x[1] * y[1] > 0.0 or stuck & 1) and (x[2] * y[2] > 0.0 or stuck & 2)


@njit(**COMPILED)
def rises(numbers):
    """Whether a friction rises towards rest, as it is or with a parameter larger."""
    found = False
    for j in range(numbers.shape[0]):
        found = found or numbers[j, OF_MOTOR + 1] != 0.0 or numbers[j, OF_LOAD + 1] != 0.0
    return found


@njit(**COMPILED)
def fill_changes(models, numbers, whole, step, changes, what):
    """Change of the whole sample's transitions (open, then closed) with each parameter, and what it changes.

    ``models`` and ``numbers``: one row as it is, then one for each parameter that is larger by ``step``; ``changes``
    (m, 2·BLOCK), ``what`` (m,).
    """
    for j in range(what.size):
        what[j] = 0
        for closed in range(2):
            for i in range(BLOCK):
                change = models[j + 1, closed * whole + i] - models[0, closed * whole + i]
                changes[j, closed * BLOCK + i] = change / step
                if change != 0.0:
                    what[j] |= _TRANSITIONS
        for i in range(NUMBERS):
            if numbers[j + 1, i] != numbers[0, i]:
                if i in (LEAD, HALF):
                    what[j] |= _GAP
                elif i <= PART:
                    what[j] |= _TORQUES


@njit(forceinline=True, **COMPILED)
def _add_product(transition, at, n, v, slope, to):
    """slope += transition · v; the transition, or its change, begins at ``at``."""
    combine(transition, at, n, v, 0, 1, slope, to, slope, to)
    combine(transition, at + WIDE * WIDE, _INPUTS, v, WIDE, 1, slope, to, slope, to)


@njit(forceinline=True, **COMPILED)
def _add_torques(t, at, c, of, x, torque, jump, per_step, slope, to):
    """slope += what acts otherwise with a parameter's numbers at c[of …]; torque and jump are what they become more."""
    add(t, at + TORQUE * WIDE, per_step * torque, slope, to)
    add(t, at + JUMP * WIDE, per_step * jump, slope, to)
    motor, load = per_step * (c[of + OF_MOTOR] - c[OF_MOTOR]), per_step * (c[of + OF_LOAD] - c[OF_LOAD])
    add(t, at + MOTOR * WIDE, motor if x[1] > 0.0 else -motor, slope, to)
    add(t, at + LOAD * WIDE, load if x[2] > 0.0 else -load, slope, to)


@njit(**COMPILED)
def follow(
    t, whole, where, c, change, what, n, torque, k, ramp, x, u, jump, edge, weight, contact, doubt, step, room, slope
):  # fmt: skip
    """Add to ``slope`` what each parameter does to the state within sample k, in which both inertias slide or rest.

    The open transition begins at t[0], the closed one at t[whole]; ``where`` are an array and the place in it of that
    which holds, with the gap closed by ``weight``; ``doubt``: deviation of the gap's argument (0: none), its rate, and
    half its way; ``room``: three columns of inputs and one of a state.
    """
    inputs, when_open, when_closed, turned = room
    base, at = where
    deviation, rate, travel = doubt
    inputs[:WIDE] = x
    inputs[TORQUE], inputs[EDGE], inputs[JUMP] = u, edge, jump
    inputs[MOTOR] = c[OF_MOTOR] if x[1] > 0.0 else -c[OF_MOTOR]
    inputs[LOAD] = c[OF_LOAD] if x[2] > 0.0 else -c[OF_LOAD]
    for i in range(COLUMNS):
        when_closed[i] = weight * inputs[i]
        when_open[i] = inputs[i] - when_closed[i]
    if deviation > 0.0:  # what a contact that is likelier does
        turned[:] = 0.0
        _add_product(t, 0, n, inputs, turned, 0)
        for i in range(WIDE):
            turned[i] = -turned[i]
        _add_product(t, whole, n, inputs, turned, 0)
    for j in range(what.size):
        of, to = (j + 1) * NUMBERS, j * WIDE
        if what[j] & _TRANSITIONS:
            if weight < 1.0:
                _add_product(change, 2 * j * BLOCK, n, when_open, slope, to)
            if weight > 0.0:
                _add_product(change, (2 * j + 1) * BLOCK, n, when_closed, slope, to)
        if what[j] & _TORQUES:
            other, turn = delayed(torque, k, c, of, ramp)
            _add_torques(base, at, c, of, x, other - u, turn - jump, 1.0 / step, slope, to)
        if what[j] & _GAP:
            place = contact * c[of + HALF]
            if deviation > 0.0:
                chance, place, _ = mean_gap(x[0] + c[of + LEAD] * rate + travel, c[of + HALF], deviation)
                add(turned, 0, (chance - weight) / step, slope, to)
            add(base, at + EDGE * WIDE, (place - edge) / step, slope, to)

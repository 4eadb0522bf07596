"""How the parameters move the state within a sample in which nothing changes, for the contact-switching filter.

While both inertias slide or rest the state after a sample is linear in the transition's entries, so its change with a
parameter is a product with the transition's change. By differences of whole motions it takes three times as long.
"""

from __future__ import annotations

from ..jit import njit
from .columns import INNER, WIDE, add, combine, copy
from .delayed_torque import delayed
from .gap_in_doubt import mean_gap
from .sliding_friction import sliding_friction
from .transitions import (
    BLOCK,
    EDGE,
    HALF,
    JUMP,
    LEAD,
    LOAD,
    MOTOR,
    NUMBERS,
    OF_LOAD,
    OF_MOTOR,
    OFFSET,
    PART,
    TORQUE,
)

#: What a parameter changes: transitions, torques, the gap, friction (layout).
_TRANSITIONS, _TORQUES, _GAP, _FRICTION = 1, 2, 4, 8
#: Columns of a transition that are not a state's, and all (layout).
_INPUTS, COLUMNS = 5, WIDE + 5


@njit(**INNER)
def slides(x, y, stuck):
    """Whether motor and load slide or rest all the way from state x to y."""
    return (x[1] * y[1] > 0.0 or stuck & 1) and (x[2] * y[2] > 0.0 or stuck & 2)


@njit(**INNER)
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
                elif i < OFFSET:
                    what[j] |= _FRICTION
                elif i <= PART:
                    what[j] |= _TORQUES


@njit(forceinline=True, **INNER)
def _add_product(transition, at, n, v, slope, to):
    """slope += transition · v; the transition, or its change, begins at ``at``."""
    combine(transition, at, n, v, 0, 1, slope, to, slope, to)
    combine(transition, at + WIDE * WIDE, _INPUTS, v, WIDE, 1, slope, to, slope, to)


@njit(forceinline=True, **INNER)
def _entry_change(t, whole, change, j, weight, chance, column, row):
    """Change of an entry of the transition that holds with parameter j; ``chance``: that of the contact's."""
    place = column * WIDE + row
    opened, closed = change[2 * j * BLOCK + place], change[(2 * j + 1) * BLOCK + place]
    return opened + weight * (closed - opened) + chance * (t[whole + place] - t[place])


@njit(forceinline=True, **INNER)
def _friction_change(c, of, place, before, free, per_torque, friction, bend, more, per, what, step):
    """Change of a sliding friction whose numbers are at ``place``: ``more`` is that of the speed that its inertia would
    have without it, ``per`` that of what a torque adds to the speed; ``bend``: its change with the speed."""
    change = bend * (more + (c[place] if before > 0.0 else -c[place]) * per)
    if what & _FRICTION:
        at = of + place
        other, _ = sliding_friction(before, free, per_torque, c[at], c[at + 1], c[at + 2])
        change += (other - friction) / step
    return change


@njit(**INNER)
def follow(
    t, whole, base, c, change, first, what, n, torque, k, ramp, x, stuck, u, jump, edge, weight, contact, doubt, step,
    room, slope,
):  # fmt: skip
    """Add to ``slope`` what each parameter does to the state within sample k, in which both inertias slide or rest.

    The open transition begins at t[0], the closed one at t[whole]; ``base`` is that which holds, with the gap closed by
    ``weight``; ``stuck``: what rests by it; the transitions' changes begin with the pair ``first`` of ``change``;
    ``doubt``: deviation of the gap's argument (0: none), its rate, and half its way; ``room``: three columns of inputs
    and one of a state.
    """
    inputs, when_open, when_closed, turned = room
    deviation, rate, travel = doubt
    copy(x, inputs)
    inputs[TORQUE], inputs[EDGE], inputs[JUMP], inputs[MOTOR], inputs[LOAD] = u, edge, jump, 0.0, 0.0
    turned[:] = 0.0
    _add_product(base, 0, n, inputs, turned, 0)
    # Without any friction, then without that of the load.
    free_motor = turned[1]
    per_motor, per_load = base[MOTOR * WIDE + 1], base[LOAD * WIDE + 2]
    motor, motor_bend, load, load_bend = 0.0, 0.0, 0.0, 0.0
    if not stuck & 1:
        motor, motor_bend = sliding_friction(
            x[1], free_motor, per_motor, c[OF_MOTOR], c[OF_MOTOR + 1], c[OF_MOTOR + 2]
        )
    free_load = turned[2] + base[MOTOR * WIDE + 2] * motor
    if not stuck & 2:
        load, load_bend = sliding_friction(
            x[2], free_load, per_load, c[OF_LOAD], c[OF_LOAD + 1], c[OF_LOAD + 2]
        )
    inputs[MOTOR], inputs[LOAD] = motor, load
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
        of, to, chance = (j + 1) * NUMBERS, j * WIDE, 0.0
        motor_before, load_before = slope[to + 1], slope[to + 2]
        if what[j] & _TRANSITIONS:
            if weight < 1.0:
                _add_product(change, 2 * (first + j) * BLOCK, n, when_open, slope, to)
            if weight > 0.0:
                _add_product(change, (2 * (first + j) + 1) * BLOCK, n, when_closed, slope, to)
        if what[j] & _TORQUES:
            other, turn = delayed(torque, k, c, of, ramp)
            add(base, TORQUE * WIDE, (other - u) / step, slope, to)
            add(base, JUMP * WIDE, (turn - jump) / step, slope, to)
        if what[j] & _GAP:
            place = contact * c[of + HALF]
            if deviation > 0.0:
                likely, place, _ = mean_gap(x[0] + c[of + LEAD] * rate + travel, c[of + HALF], deviation)
                chance = (likely - weight) / step
                add(turned, 0, chance, slope, to)
            add(base, EDGE * WIDE, (place - edge) / step, slope, to)
        # Until here the frictions are what they are without the change.
        if not stuck & 1:
            per = _entry_change(t, whole, change, first + j, weight, chance, MOTOR, 1)
            beside = _entry_change(t, whole, change, first + j, weight, chance, LOAD, 1)
            more = slope[to + 1] - motor_before - motor * per - load * beside
            more = _friction_change(
                c, of, OF_MOTOR, x[1], free_motor, per_motor, motor, motor_bend, more, per, what[j], step
            )
            if more != 0.0:
                add(base, MOTOR * WIDE, more, slope, to)
        if not stuck & 2:
            per = _entry_change(t, whole, change, first + j, weight, chance, LOAD, 2)
            more = slope[to + 2] - load_before - load * per
            more = _friction_change(
                c, of, OF_LOAD, x[2], free_load, per_load, load, load_bend, more, per, what[j], step
            )
            if more != 0.0:
                add(base, LOAD * WIDE, more, slope, to)

"""Transitions of the drivetrain model over a sample and its parts, for each state of the contact.

States::

    twist at the gap, speed_motor, speed_load, [twist before, speed of the third mass], [load torque], [its slope],
    [angle_motor], torque_actuator

The last is known without error; the covariance is that of the others.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import njit
from .columns import COMPILED, NOTHING, WIDE, combine
from .intermediate_inertia import two_springs
from .sample_parts import DIGIT, part_number, part_within, parts, shape_mean, until_change
from .two_mass import add_series, congruence, product

# Places in a row of parameters, SI units. A share of zero: two masses. An infinite stiffness: rigid. A torque rate of
# zero: no unknown load torque. ``TORQUE_OFFSET``: what acts on the motor beside the torque of the recording, always the
# same; friction that differs by direction is such a torque beside friction that does not, also at rest. ``IMPACT``: how
# far the speeds after a contact changes may be off, over the approach.
(
    INERTIA_MOTOR, INERTIA_LOAD, STIFFNESS, DAMPING, BACKLASH, COULOMB, VISCOUS, COULOMB_MOTOR, VISCOUS_MOTOR, LAG,
    DELAY, TORQUE_OFFSET, SHARE, COMPLIANCE, LOSS, MOTOR_RATE, LOAD_RATE, TORQUE_RATE, RISE, FADE, RISE_MOTOR,
    FADE_MOTOR, IMPACT,
) = range(23)  # fmt: skip

#: Contact laws, see ``drivetrain.Shaft``; the last is what a model without a gap has.
VISCOELASTIC, DEAD_ZONE, CLIPPED, LIMITED, NO_GAP = range(5)

#: A transition's columns: states, then torque, gap edge, friction of motor and of load, and what a torque that changes
#: within the sample does that its mean does not (of a whole sample alone).
TORQUE, EDGE, MOTOR, LOAD, JUMP = range(WIDE, WIDE + 5)
#: Numbers in a transition, which lies column after column.
BLOCK = (WIDE + 5) * WIDE

#: Places among a model's numbers (layout): lead of the gap's argument (s), half the gap (rad), of the friction of the
#: motor and of that of the load the Coulomb level (Nm), its rise towards rest and the speed over which that fades
#: (rad/s), constant torque on the motor (Nm), delay in whole samples and its rest, and by how much the speeds before
#: and behind the gap may be off after the contact has changed, over the approach and the noise.
LEAD, HALF, OF_MOTOR, OF_LOAD, OFFSET, WHOLE, PART, KICKS, NUMBERS = 0, 1, 2, 5, 8, 9, 10, 11, 13

#: Largest norm before squaring, as in ``two_mass`` (numerics).
_NORM = 0.5
#: What no transition depends on, of what is ever free.
_BESIDE = (BACKLASH, COULOMB, COULOMB_MOTOR, TORQUE_OFFSET, RISE, FADE, RISE_MOTOR, FADE_MOTOR)
#: Halvings of a sample whose torque is a ramp, to find what the ramp does (numerics: 1e-4 of it).
_RAMP = 6
#: A lag below this part of a sample is none: its pole would take the digits of all others (numerics).
_NO_LAG = 1e-6


@njit(**COMPILED)
def layout(q, angled, behind, drifts):
    """Places among the states of third mass, load torque, its slope and angle (0: none), and of the speeds before and
    behind the gap; states; states with a covariance. ``behind``: the third mass sits behind the gap, else before it;
    ``drifts``: the load torque has a slope."""
    third = 3 if q[SHARE] > 0.0 else 0
    tail, head = third + 1 if third > 0 and not behind else 1, third + 1 if third > 0 and behind else 2
    nc = 5 if third > 0 else 3
    load = nc if q[TORQUE_RATE] > 0.0 else 0
    nc += 1 if load > 0 else 0
    slope = nc if load > 0 and drifts else 0
    nc += 1 if slope > 0 else 0
    angle = nc if angled else 0
    nc += 1 if angle > 0 else 0
    return third, load, slope, angle, tail, head, nc + 1, nc


@njit(**COMPILED)
def _damped_spring(block, behind, before, spring, damper, j_before, j_behind):
    """A spring and a damper between two speeds; ``before`` and ``behind``: (twist, speed) places."""
    twist, first = before
    second = behind
    block[twist, first] += 1.0
    block[twist, second] -= 1.0
    block[first, twist] -= spring / j_before
    block[second, twist] += spring / j_behind
    block[first, first] -= damper / j_before
    block[first, second] += damper / j_before
    block[second, first] += damper / j_behind
    block[second, second] -= damper / j_behind


@njit(**COMPILED)
def _shafts(q, behind):
    """Stiffness of the shaft with the gap and of the further one, Nm/rad, and damping over stiffness of either, s.

    ``STIFFNESS`` is that of two masses with the same torsional mode; ``DAMPING`` is that of both shafts in series, in
    slow motion; the further one's damping over stiffness is ``LOSS`` times that of the other.
    """
    if q[SHARE] == 0.0:
        rate = q[DAMPING] / q[STIFFNESS]
        return q[STIFFNESS], np.inf, rate, rate
    near, far = q[INERTIA_MOTOR], q[INERTIA_LOAD]
    if behind:
        near, far = far, near
    further, own = two_springs(near, far, q[STIFFNESS], q[SHARE], q[COMPLIANCE])
    rate = q[DAMPING] * (1.0 / further + 1.0 / own) / (1.0 + (q[LOSS] - 1.0) * q[COMPLIANCE])
    return own, further, rate, q[LOSS] * rate


@njit(**COMPILED)
def _at_the_gap(q, third, behind):
    """Inertias before and behind the gap."""
    if not third:
        return q[INERTIA_MOTOR], q[INERTIA_LOAD]
    if behind:
        return q[INERTIA_MOTOR], q[SHARE] * q[INERTIA_LOAD]
    return q[SHARE] * q[INERTIA_MOTOR], q[INERTIA_LOAD]


@njit(**COMPILED)
def fill_continuous(q, dt, places, closed, law, stuck, block):
    """Fill the block [A, inputs; 0, 0] for the gap closed or open; ``places``: see ``layout``; ``stuck``: 1 if the
    motor rests, plus 2 if the load does."""
    third, load, slope, angle, tail, head, n, _ = places
    block[:] = 0.0
    jm, jl = q[INERTIA_MOTOR], q[INERTIA_LOAD]
    k, further, rate, other = _shafts(q, head != 2)
    j_tail, j_head = _at_the_gap(q, third > 0, head != 2)
    if third > 0 and head == 2:
        jm -= j_tail
        _damped_spring(block, tail, (third, 1), further, other * further, jm, j_tail)
    elif third > 0:
        jl -= j_head
        _damped_spring(block, 2, (third, head), further, other * further, j_head, jl)
    spring = k if closed else 0.0
    damper = rate * k if closed or law == DEAD_ZONE else 0.0
    if math.isinf(k):  # rigid: there is one inertia, the motor's
        spring = damper = 0.0
    _damped_spring(block, head, (0, tail), spring, damper, j_tail, j_head)
    block[tail, n + 1], block[head, n + 1] = spring / j_tail, -spring / j_head
    block[1, 1] -= q[VISCOUS_MOTOR] / jm
    block[2, 2] -= q[VISCOUS] / jl
    if load > 0:
        block[2, load] = 1.0 / jl
    if slope > 0:
        block[load, slope] = 1.0
    if angle > 0:
        block[angle, 1] = 1.0
    if q[LAG] > _NO_LAG * dt:
        block[1, n - 1], block[n - 1, n - 1], block[n - 1, n] = 1.0 / jm, -1.0 / q[LAG], 1.0 / q[LAG]
    else:
        block[1, n] = 1.0 / jm
    block[1, n + 2], block[2, n + 3] = -1.0 / jm, -1.0 / jl
    for end in range(2):
        if stuck & (1 << end):
            block[1 + end] = 0.0


@njit(**COMPILED)
def _transitions(block, density, dt, n, finest, table, at, noise):
    """Transitions over the parts of a sample, see ``sample_parts``, from table[at] on, and noise =
    ∫exp(A·s)·density·exp(Aᵀ·s)ds over dt.

    By series and doublings; n states, whose columns come first. No noise where density is empty.
    """
    size, states = block.shape[0], density.shape[0]
    norm, doublings = 0.0, 0
    for i in range(size):
        total = 0.0
        for j in range(size):
            total += abs(block[i, j]) * dt
        norm = max(norm, total)
    while norm > _NORM or doublings < finest:
        norm *= 0.5
        doublings += 1
    h = dt / 2.0**doublings
    step, term, other = np.zeros((size, size)), np.zeros((size, size)), np.zeros((size, size))
    half, rest = np.zeros((states, states)), density.copy()
    for i in range(size):
        step[i, i] = term[i, i] = 1.0
    noise[:] = 0.0
    add_series(block, rest, half, term, other, h, step, noise)
    for left in range(doublings, -1, -1):
        if left <= finest:
            to = at + part_number(1 << (finest - left), finest) * BLOCK
            for i in range(n):
                for j in range(n):
                    table[to + j * WIDE + i] = step[i, j]
                for j in range(4):
                    table[to + (WIDE + j) * WIDE + i] = step[i, n + j]
        if left > 0:
            congruence(step, noise, half, noise, False)
            product(step, step, other)
            step, other = other, step
    _fill_sums(table, at, n, finest)


@njit(**COMPILED)
def _fill_sums(table, at, n, finest):
    """Fill the transitions over 3, 5, 6 and 7 pieces of each size from those over 1, 2 and 4."""
    for digit in range(0, finest, DIGIT):
        for first, second in ((2, 1), (4, 1), (4, 2), (4, 3)):
            if (first + second) << digit < 1 << finest:
                _join(table, at, n, finest, first << digit, second << digit)


@njit(**COMPILED)
def _join(table, at, n, finest, first, second):
    """Fill the transition over two parts, one after the other, from those of either."""
    a, b = at + part_number(first, finest) * BLOCK, at + part_number(second, finest) * BLOCK
    to = at + part_number(first + second, finest) * BLOCK
    for column in range(WIDE + 4):
        if column < n:
            combine(table, b, n, table, a + column * WIDE, 1, NOTHING, 0, table, to + column * WIDE)
        elif column >= WIDE:
            base = b + column * WIDE
            combine(table, b, n, table, a + column * WIDE, 1, table, base, table, to + column * WIDE)


@njit(**COMPILED)
def _fill_jump(table, at, finest, n, part):
    """Column ``JUMP`` of the whole sample: what ``shape_mean`` adds."""
    x, y, done = np.zeros(WIDE), np.zeros(WIDE), 0
    while done < 1 << finest:
        size = part_within(until_change(part, finest, done), finest)
        if part < 0.0:
            size = 1 << max(finest - _RAMP, 0)
        column = at + part_number(size, finest) * BLOCK
        mean = shape_mean(part, finest, done, size)
        for i in range(n):
            y[i] = mean * table[column + TORQUE * WIDE + i]
            for j in range(n):
                y[i] += table[column + j * WIDE + i] * x[j]
        x, y = y, x
        done += size
    for i in range(n):
        table[at + JUMP * WIDE + i] = x[i]


@njit(**COMPILED)
def fill_model(q, dt, law, finest, kind, level, table, c, noise):
    """Fill transitions (open, then closed, each from the whole sample to its finest part), numbers and noise.

    ``kind``: whether the torque is a ramp, a third mass sits behind the gap, the load torque has a slope, the speed is
    counted, the angle a state.
    """
    fill_transitions(q, dt, law, finest, kind, level, 0, table, noise)
    fill_numbers(q, dt, law, kind[1], level, c)


@njit(**COMPILED)
def fill_transitions(q, dt, law, finest, kind, level, stuck, table, noise):
    """Fill transitions and noise, see ``fill_model``; ``stuck``: 1 if the motor rests all the while, plus 2 if the load
    does. An empty ``noise`` is not filled."""
    ramp, behind, drifts, counted, angled = kind
    places = layout(q, angled, behind, drifts)
    third, load, slope, _, _, _, n, nc = places
    states = nc if noise.size > 0 else 0
    block, density, own = np.zeros((n + 4, n + 4)), np.zeros((states, states)), np.zeros((states, states))
    if states > 0:
        _fill_density(q, dt, third, load, slope, counted, behind, level, density)
    for closed in range(2):
        fill_continuous(q, dt, places, closed == 1, law, stuck, block)
        at = closed * parts(finest) * BLOCK
        _transitions(block, density, dt, n, finest, table, at, own)
        _fill_jump(table, at, finest, n, -1.0 if ramp else q[DELAY] / dt - math.floor(q[DELAY] / dt))
        for i in range(states):
            for j in range(states):
                noise[(closed * WIDE + i) * WIDE + j] = own[i, j]


@njit(**COMPILED)
def _fill_density(q, dt, third, load, slope, counted, behind, level, density):
    """Torque noise that moves motor or load as fast as their rates say: a lone inertia that is seen by its speed, or by
    its angle, has a filter of that bandwidth."""
    power = 4.0 if counted else 2.0
    density[1, 1], density[2, 2] = q[MOTOR_RATE] ** power * dt, q[LOAD_RATE] ** power * dt
    if third > 0:
        density[third + 1, third + 1] = density[2, 2] if behind else density[1, 1]
    if load > 0:  # the rate is that of the torque in a second, or of its slope
        noisy = slope if slope > 0 else load
        density[noisy, noisy] = (q[TORQUE_RATE] / level) ** 2


@njit(**COMPILED)
def fill_numbers(q, dt, law, behind, level, c):
    """Fill what a model has beside its transitions."""
    c[LEAD] = 0.0 if law == DEAD_ZONE else _shafts(q, behind)[2]
    c[HALF] = 0.5 * q[BACKLASH]
    c[OF_MOTOR], c[OF_MOTOR + 1], c[OF_MOTOR + 2] = q[COULOMB_MOTOR], q[RISE_MOTOR], q[FADE_MOTOR]
    c[OF_LOAD], c[OF_LOAD + 1], c[OF_LOAD + 2] = q[COULOMB], q[RISE], q[FADE]
    c[OFFSET] = q[TORQUE_OFFSET]
    c[WHOLE] = math.floor(q[DELAY] / dt)
    c[PART] = q[DELAY] / dt - c[WHOLE]
    # What an impact's force does otherwise than its law says acts on both sides of the gap.
    j_tail, j_head = _at_the_gap(q, q[SHARE] > 0.0, behind)
    kick = q[IMPACT] / (j_tail + j_head) / level
    c[KICKS], c[KICKS + 1] = kick * j_head, -kick * j_tail


@njit(**COMPILED)
def fill_changed_model(place, q, dt, law, finest, kind, level, stuck, models, row):
    """Fill row ``row`` of the models' transitions, which differs from row 0 in the parameter at ``place``: what that
    does not change is copied."""
    if place in _BESIDE:
        models[row] = models[0]
    else:
        fill_transitions(q, dt, law, finest, kind, level, stuck, models[row], np.zeros(0))

"""Transitions of the drivetrain model over a sample and its parts, for each state of the contact.

States::

    twist at the gap, speed_motor, speed_load, [twist and speed of the third mass], [those of the fourth],
    [load torque], [its slope], [angle_motor], torque_actuator

The last is known without error; the covariance is that of the others.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import njit
from .columns import COMPILED, NONE, NOTHING, WIDE, combine
from .intermediate_inertia import lowest_mode, two_springs
from .sample_parts import DIGIT, part_number, part_within, parts, shape_mean, until_change
from .two_mass import add_series, congruence, product

# Places in a row of parameters, SI units. A share of zero: two masses. An infinite stiffness: rigid. A torque rate of
# zero: no unknown load torque. ``TORQUE_OFFSET``: what acts on the motor beside the torque of the recording, always the
# same; friction that differs by direction is such a torque beside friction that does not, also at rest. ``IMPACT``: how
# far the speeds after a contact changes may be off, over the approach. The fourth mass divides what the third leaves at
# the gap, or the other side: its share is part of that inertia, its compliance part of that of the shaft at the gap.
(
    INERTIA_MOTOR,
    INERTIA_LOAD,
    STIFFNESS,
    DAMPING,
    BACKLASH,
    COULOMB,
    VISCOUS,
    COULOMB_MOTOR,
    VISCOUS_MOTOR,
    LAG,
    DELAY,
    TORQUE_OFFSET,
    SHARE,
    COMPLIANCE,
    LOSS,
    MOTOR_RATE,
    LOAD_RATE,
    TORQUE_RATE,
    RISE,
    FADE,
    RISE_MOTOR,
    FADE_MOTOR,
    IMPACT,
    SHARE_FOURTH,
    COMPLIANCE_FOURTH,
    LOSS_FOURTH,
) = range(26)
# Bits of ``behind``: which further masses sit behind the gap, and are part of the load; else before it, of the motor.
_THIRD, _FOURTH = 1, 2  # fmt: skip

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
    """Places among the states of third and fourth mass, load torque, its slope and angle (0: none), and of the speeds
    before and behind the gap; states; states with a covariance. ``behind``: bits of the masses behind the gap;
    ``drifts``: the load torque has a slope."""
    third = 3 if q[SHARE] > 0.0 else 0
    fourth = 5 if third > 0 and q[SHARE_FOURTH] > 0.0 else 0
    tail, head, nc = 1, 2, 3
    for place, side in ((third, behind & _THIRD), (fourth, behind & _FOURTH)):
        if place > 0:
            nc += 2
            if side:
                head = place + 1
            else:
                tail = place + 1
    load = nc if q[TORQUE_RATE] > 0.0 else 0
    nc += 1 if load > 0 else 0
    slope = nc if load > 0 and drifts else 0
    nc += 1 if slope > 0 else 0
    angle = nc if angled else 0
    nc += 1 if angle > 0 else 0
    return third, fourth, load, slope, angle, tail, head, nc + 1, nc


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
    """Stiffness of the shaft with the gap, of the third mass's and of the fourth's, Nm/rad (infinite: none), and
    damping over stiffness of the first, s.

    ``STIFFNESS`` is that of two masses with the same torsional mode; ``DAMPING`` is that of all shafts in series, in
    slow motion; a further one's damping over stiffness is ``LOSS`` times that of the shaft with the gap.
    """
    rate = q[DAMPING] / q[STIFFNESS]
    if q[SHARE] == 0.0:
        return q[STIFFNESS], np.inf, np.inf, rate
    rest, lossy = 1.0 - q[COMPLIANCE], q[LOSS] * q[COMPLIANCE]
    if q[SHARE_FOURTH] == 0.0:
        near, far = q[INERTIA_MOTOR], q[INERTIA_LOAD]
        if behind & _THIRD:
            near, far = far, near
        further, own = two_springs(near, far, q[STIFFNESS], q[SHARE], q[COMPLIANCE])
        rate = q[DAMPING] * (1.0 / further + 1.0 / own) / (rest + lossy)
        return own, further, np.inf, rate
    fourth = q[COMPLIANCE_FOURTH] * rest
    rest -= fourth
    lossy += q[LOSS_FOURTH] * fourth
    masses, springs = _in_order(q, behind, rest, fourth)
    series = q[STIFFNESS] * (1.0 / q[INERTIA_MOTOR] + 1.0 / q[INERTIA_LOAD]) / lowest_mode(masses, springs)
    rate = q[DAMPING] / series / (rest + lossy)
    return series / rest, series / q[COMPLIANCE], series / fourth, rate


@njit(**COMPILED)
def _in_order(q, behind, rest, fourth):
    """Four inertias from motor to load, and the stiffnesses between them with a compliance of one together."""
    jm, jl, j_third, j_fourth = _inertias(q, behind)
    own, third, last = 1.0 / rest, 1.0 / q[COMPLIANCE], 1.0 / fourth
    if behind == _THIRD + _FOURTH:
        return (jm, j_fourth, j_third, jl), (own, last, third)
    if behind == _THIRD:
        return (jm, j_fourth, j_third, jl), (last, own, third)
    if behind == _FOURTH:
        return (jm, j_third, j_fourth, jl), (third, own, last)
    return (jm, j_third, j_fourth, jl), (third, last, own)


@njit(**COMPILED)
def _inertias(q, behind):
    """Inertias of motor, load, third and fourth mass; none has that of an end."""
    jm, jl, third, fourth = q[INERTIA_MOTOR], q[INERTIA_LOAD], 0.0, 0.0
    if q[SHARE] > 0.0:
        third = q[SHARE] * (jl if behind & _THIRD else jm)
        if behind & _THIRD:
            jl -= third
        else:
            jm -= third
        if q[SHARE_FOURTH] > 0.0:
            if (behind & _THIRD > 0) == (behind & _FOURTH > 0):
                fourth = q[SHARE_FOURTH] * third
                third -= fourth
            elif behind & _FOURTH:
                fourth = q[SHARE_FOURTH] * jl
                jl -= fourth
            else:
                fourth = q[SHARE_FOURTH] * jm
                jm -= fourth
    return jm, jl, third, fourth


@njit(**COMPILED)
def _at_the_gap(q, behind):
    """Inertias before and behind the gap."""
    jm, jl, third, fourth = _inertias(q, behind)
    tail, head = jm, jl
    for inertia, side in ((third, behind & _THIRD), (fourth, behind & _FOURTH)):
        if inertia > 0.0:
            if side:
                head = inertia
            else:
                tail = inertia
    return tail, head


@njit(**COMPILED)
def fill_continuous(q, dt, places, behind, closed, law, stuck, block):
    """Fill the block [A, inputs; 0, 0] for the gap closed or open; ``places``: see ``layout``; ``stuck``: 1 if the
    motor rests, plus 2 if the load does."""
    third, fourth, load, slope, angle, tail, head, n, _ = places
    block[:] = 0.0
    k, k_third, k_fourth, rate = _shafts(q, behind)
    jm, jl, j_third, j_fourth = _inertias(q, behind)
    j_tail, j_head = _at_the_gap(q, behind)
    # Each further mass hangs on the one outside of it, which is an end or the third.
    before, j_before, after, j_after = 1, jm, 2, jl
    for place, spring, loss, inertia, side in (
        (third, k_third, q[LOSS], j_third, behind & _THIRD),
        (fourth, k_fourth, q[LOSS_FOURTH], j_fourth, behind & _FOURTH),
    ):
        if place > 0 and side:
            _damped_spring(block, after, (place, place + 1), spring, loss * rate * spring, inertia, j_after)
            after, j_after = place + 1, inertia
        elif place > 0:
            _damped_spring(block, place + 1, (place, before), spring, loss * rate * spring, j_before, inertia)
            before, j_before = place + 1, inertia
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

    ``kind``: whether the torque is a ramp, bits of the masses behind the gap, whether the load torque has a slope, the
    speed is counted, the angle a state.
    """
    fill_transitions(q, dt, law, finest, kind, level, NONE, table, noise)
    fill_numbers(q, dt, law, kind[1], level, c)


@njit(**COMPILED)
def fill_transitions(q, dt, law, finest, kind, level, stuck, table, noise):
    """Fill transitions and noise, see ``fill_model``; ``stuck``: 1 if the motor rests all the while, plus 2 if the load
    does. An empty ``noise`` is not filled."""
    ramp, behind, drifts, counted, angled = kind
    places = layout(q, angled, behind, drifts)
    n, nc = places[7], places[8]
    states = nc if noise.size > 0 else 0
    block, density, own = np.zeros((n + 4, n + 4)), np.zeros((states, states)), np.zeros((states, states))
    if states > 0:
        _fill_density(q, dt, places, counted, behind, level, density)
    for closed in range(2):
        fill_continuous(q, dt, places, behind, closed == 1, law, stuck, block)
        at = closed * parts(finest) * BLOCK
        _transitions(block, density, dt, n, finest, table, at, own)
        _fill_jump(table, at, finest, n, -1.0 if ramp else q[DELAY] / dt - math.floor(q[DELAY] / dt))
        for i in range(states):
            for j in range(states):
                noise[(closed * WIDE + i) * WIDE + j] = own[i, j]


@njit(**COMPILED)
def _fill_density(q, dt, places, counted, behind, level, density):
    """Torque noise that moves motor or load as fast as their rates say: a lone inertia that is seen by its speed, or by
    its angle, has a filter of that bandwidth."""
    third, fourth, load, slope = places[:4]
    power = 4.0 if counted else 2.0
    density[1, 1], density[2, 2] = q[MOTOR_RATE] ** power * dt, q[LOAD_RATE] ** power * dt
    for place, side in ((third, behind & _THIRD), (fourth, behind & _FOURTH)):
        if place > 0:
            density[place + 1, place + 1] = density[2, 2] if side else density[1, 1]
    if load > 0:  # the rate is that of the torque in a second, or of its slope
        noisy = slope if slope > 0 else load
        density[noisy, noisy] = (q[TORQUE_RATE] / level) ** 2


@njit(**COMPILED)
def fill_numbers(q, dt, law, behind, level, c):
    """Fill what a model has beside its transitions."""
    c[LEAD] = 0.0 if law == DEAD_ZONE else _shafts(q, behind)[3]
    c[HALF] = 0.5 * q[BACKLASH]
    c[OF_MOTOR], c[OF_MOTOR + 1], c[OF_MOTOR + 2] = q[COULOMB_MOTOR], q[RISE_MOTOR], q[FADE_MOTOR]
    c[OF_LOAD], c[OF_LOAD + 1], c[OF_LOAD + 2] = q[COULOMB], q[RISE], q[FADE]
    c[OFFSET] = q[TORQUE_OFFSET]
    c[WHOLE] = math.floor(q[DELAY] / dt)
    c[PART] = q[DELAY] / dt - c[WHOLE]
    # What an impact's force does otherwise than its law says acts on both sides of the gap.
    j_tail, j_head = _at_the_gap(q, behind)
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

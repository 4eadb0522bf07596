"""Rows of one mode of a plant over s = [x, inputs, 1]: torques, rates and guards from the drivetrain's numbers."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..jit import njit
from .layout import FRICTION, SHAFT, Indices

#: Contact laws of a shaft. LINEAR: no backlash; without damping PHYSICAL is VISCOELASTIC.
LINEAR, VISCOELASTIC, DEAD_ZONE, LIMITED, CLIPPED, PHYSICAL = range(6)
#: Digits of a shaft with backlash, ordered along the twist.
MINUS, GAP, PLUS = 0, 1, 2
#: Columns of ``Chain.shafts``, ``Chain.inertias`` and ``Chain.elements``.
LAW, ANGLE, ELEMENT, SUM, DIFFERENCE = range(5)
ELEMENT_OF_FRICTION, POINT = range(2)
KIND, INDEX, REST = range(3)
#: Numbers of a shaft (stiffness, damping, half the backlash) and of a friction (viscous, Coulomb level of positive and
#: negative speed, breakaway level of positive and negative torque) (layout).
SHAFT_NUMBERS, FRICTION_NUMBERS = 3, 5


class Chain(NamedTuple):
    """What the variants of one plant share. Their numbers are one vector each, in the order

    dt, lag; n inertias; n − 1 times the numbers of a shaft; n times those of a friction; points of the Stribeck curves
    (speed, extra torque).
    """

    shafts: Indices  # (n − 1, 5): law; state of the shaft's own angle; elements of the shaft, of the sign of
    #                  k·dz(twist) + d·rate, and of k·dz(twist) − d·rate; −1 for none
    inertias: Indices  # (n + 1, 2): element of the friction, −1 for none; first point of the Stribeck curve
    elements: (
        Indices  # (E, 3): SHAFT, FRICTION or BRANCH; shaft or inertia; digit of the gap or of standstill
    )
    targets: Indices  # (M,): inertia on which an input's torque acts; −1 − i: it is inertia i's acceleration
    states: int
    actuator: int  # state of the actuator's torque, −1 for none
    locked: int  # inertia that is held, −1 for none


_MODES: Any = {"cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True}
#: Of what Python does not call: a part of the time to compile goes into its wrappers.
_INNER: Any = {**_MODES, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


@njit(**_INNER)
def _friction_segment(chain, p, i, digit):
    """(constant, slope, low, high): torque = constant + slope·speed of a moving digit, between two speeds."""
    n = chain.inertias.shape[0] - 1
    at = 2 + n + SHAFT_NUMBERS * (n - 1) + FRICTION_NUMBERS * i
    away = digit - chain.elements[chain.inertias[i, ELEMENT_OF_FRICTION], REST]
    sign = 1.0 if away > 0 else -1.0
    level = p[at + 1] if away > 0 else p[at + 2]
    number, last = chain.inertias[i, POINT] + abs(away) - 1, chain.inertias[i + 1, POINT]
    point = 2 + n + SHAFT_NUMBERS * (n - 1) + FRICTION_NUMBERS * n + 2 * number
    near, extra, far, slope = 0.0, 0.0, np.inf, 0.0
    if number < last:
        near, extra = p[point], p[point + 1]
    if number + 1 < last:
        far = p[point + 2]
        slope = (p[point + 3] - extra) / (far - near)
    constant = sign * (level + extra - slope * near)
    if away > 0:
        return constant, slope, near, far
    return constant, slope, -far, -near


@njit(**_INNER)
def _torque_rows(chain, p, digits, rows):
    """Torques of shafts and their springs, from outside, and of friction."""
    shafts, inertias = chain.shafts, chain.inertias
    n, last = inertias.shape[0] - 1, rows.shape[1] - 1
    for i in range(n - 1):
        at, elastic = 2 + n + SHAFT_NUMBERS * i, n - 1 + i
        k, d, half = p[at], p[at + 1], p[at + 2]
        law, speed = shafts[i, LAW], n - 1 + i
        if law == LINEAR:
            rows[i, i], rows[i, speed], rows[i, speed + 1] = k, d, -d
            continue
        side = digits[shafts[i, ELEMENT]]
        right = 1 if side == PLUS else 0  # on the left flank all signs are the other way round
        offset = -k * (side - GAP) * half
        rows[elastic, i], rows[elastic, last] = k, offset
        spring, damped = 1.0, True
        if side == GAP:
            spring, damped = 0.0, law == DEAD_ZONE
        elif law == PHYSICAL:
            spring = 0.0
            rows[i, shafts[i, ANGLE]] = k
        elif law >= LIMITED and digits[shafts[i, SUM]] != right:
            spring, damped = 0.0, False
        elif law == LIMITED and digits[shafts[i, DIFFERENCE]] != right:
            spring, damped = 2.0, False
        rows[i, i], rows[i, last] = spring * k, spring * offset
        if damped:
            rows[i, speed], rows[i, speed + 1] = d, -d
    for j in range(chain.targets.size):
        i = chain.targets[j]
        if i >= 0:
            source = chain.actuator if j == 0 and chain.actuator >= 0 else chain.states + j
            rows[2 * (n - 1) + i, source] = 1.0
    for i in range(n):
        friction, e = 3 * n - 2 + i, inertias[i, ELEMENT_OF_FRICTION]
        rows[friction, n - 1 + i] = p[2 + n + SHAFT_NUMBERS * (n - 1) + FRICTION_NUMBERS * i]
        if e >= 0 and digits[e] != chain.elements[e, REST]:
            constant, slope, _, _ = _friction_segment(chain, p, i, digits[e])
            rows[friction, n - 1 + i] += slope
            rows[friction, last] = constant


@njit(inline="always", **_INNER)
def driving_torque(rows, n, i, j):
    """Torque on inertia i without its friction, column j."""
    torque = rows[2 * (n - 1) + i, j]
    if i > 0:
        torque += rows[i - 1, j]
    if i < n - 1:
        torque -= rows[i, j]
    return torque


@njit(**_INNER)
def _rate_rows(chain, p, digits, rows):
    """dx/dt."""
    shafts, inertias, states = chain.shafts, chain.inertias, chain.states
    n = inertias.shape[0] - 1
    rate = 4 * n - 2
    for i in range(n - 1):
        speed, angle = n - 1 + i, shafts[i, ANGLE]
        rows[rate + i, speed], rows[rate + i, speed + 1] = 1.0, -1.0
        if angle < 0:
            continue
        if digits[shafts[i, ELEMENT]] == GAP:
            at = 2 + n + SHAFT_NUMBERS * i
            rows[rate + angle, angle] = -(p[at] / p[at + 1])
        else:
            rows[rate + angle, speed], rows[rate + angle, speed + 1] = 1.0, -1.0
    for i in range(n):
        e = inertias[i, ELEMENT_OF_FRICTION]
        if i == chain.locked or (e >= 0 and digits[e] == chain.elements[e, REST]):
            continue
        for j in range(rows.shape[1]):
            torque = driving_torque(rows, n, i, j) - rows[3 * n - 2 + i, j]
            rows[rate + n - 1 + i, j] = torque / p[2 + i]
    for j in range(chain.targets.size):
        if chain.targets[j] < 0:
            rows[rate + n - 2 - chain.targets[j], states + j] = 1.0
    rows[rate + 2 * n - 1, n - 1] = 1.0
    if chain.actuator >= 0:
        rows[rate + chain.actuator, states] = 1.0 / p[1]
        rows[rate + chain.actuator, chain.actuator] = -1.0 / p[1]


@njit(**_INNER)
def _guard_rows(chain, p, digits, rows, bounds):
    """What decides impact, bounce, separation, stick, slip: a contact state lasts while its guards keep their bounds.

    Guard of a gap: the twist, rad (``viscoelastic``: plus damping/stiffness times its rate; ``physical``: less the
    shaft's own angle, in contact the shaft torque, Nm). Of a friction: the driving torque (Nm) at rest, else the speed
    (rad/s). Of a branch of ``limited`` or ``clipped``: spring torque plus or minus damping torque, Nm.
    """
    shafts, elements = chain.shafts, chain.elements
    n = chain.inertias.shape[0] - 1
    columns = rows.shape[1]
    for e in range(elements.shape[0]):
        i, digit, guard = elements[e, INDEX], digits[e], 4 * n - 2 + chain.states + e
        low, high = -np.inf, np.inf
        at = 2 + n + SHAFT_NUMBERS * i
        if elements[e, KIND] == SHAFT:
            k, d, half = p[at], p[at + 1], p[at + 2]
            law = shafts[i, LAW]
            if law == PHYSICAL and digit != GAP:
                half = 0.0
                for j in range(columns):
                    rows[guard, j] = rows[i, j]
            else:
                rows[guard, i] = 1.0
                if law == PHYSICAL:
                    rows[guard, shafts[i, ANGLE]] = -1.0
                elif law == VISCOELASTIC:
                    rows[guard, n - 1 + i], rows[guard, n + i] = d / k, -d / k
            if digit != MINUS:
                low = half if digit == PLUS else -half
            if digit != PLUS:
                high = -half if digit == MINUS else half
        elif elements[e, KIND] == FRICTION:
            if digit == elements[e, REST]:
                at = 2 + n + SHAFT_NUMBERS * (n - 1) + FRICTION_NUMBERS * i
                low, high = -p[at + 4], p[at + 3]
                for j in range(columns):
                    rows[guard, j] = driving_torque(rows, n, i, j)
            else:
                _, _, low, high = _friction_segment(chain, p, i, digit)
                rows[guard, n - 1 + i] = 1.0
        elif digits[shafts[i, ELEMENT]] != GAP:
            d = p[at + 1] if shafts[i, SUM] == e else -p[at + 1]
            rows[guard, i], rows[guard, columns - 1] = rows[n - 1 + i, i], rows[n - 1 + i, columns - 1]
            rows[guard, n - 1 + i], rows[guard, n + i] = d, -d
            if digit == 1:
                low = 0.0
            else:
                high = 0.0
        bounds[e, 0], bounds[e, 1] = low, high


@njit(**_INNER)
def fill_rows(chain, p, digits, rows, bounds):
    """All rows of the mode of these digits, see ``contact_states.ModeWork``."""
    rows[:] = 0.0
    _torque_rows(chain, p, digits, rows)
    _rate_rows(chain, p, digits, rows)
    _guard_rows(chain, p, digits, rows, bounds)


@njit(**_MODES)
def start_digits(chain, p, x, digits):
    """The mode in which a state lies; sets the shaft angle of the physical law in x where the twist tells it."""
    n = chain.inertias.shape[0] - 1
    for e in range(chain.elements.shape[0]):
        i, rest = chain.elements[e, INDEX], chain.elements[e, REST]
        digits[e] = 1  # of a branch: put right by an event at once where it is wrong
        if chain.elements[e, KIND] == FRICTION:
            digits[e] = rest
            speed = x[n - 1 + i]
            if speed == 0.0:
                continue
            step = 1 if speed > 0.0 else -1
            low, high = np.inf, -np.inf
            while not low <= speed <= high:
                digits[e] += step
                _, _, low, high = _friction_segment(chain, p, i, digits[e])
        elif chain.elements[e, KIND] == SHAFT:
            at = 2 + n + SHAFT_NUMBERS * i
            half, reach = p[at + 2], x[i]
            if chain.shafts[i, LAW] == VISCOELASTIC:
                reach += p[at + 1] / p[at] * (x[n - 1 + i] - x[n + i])
            digits[e] = PLUS if reach > half else MINUS if reach < -half else GAP
            if chain.shafts[i, ANGLE] >= 0:
                x[chain.shafts[i, ANGLE]] = reach - min(max(reach, -half), half)

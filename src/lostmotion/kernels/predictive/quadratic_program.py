"""A small quadratic program with a box and soft rows, solved by Newton steps on the moves that are free.

    min ½ Uᵀ H U + (G ξ)ᵀ U + ½ ξᵀ Q ξ + ½ Σ ρ·dist(aᵣᵀU + fᵣᵀξ, [lowᵣ, highᵣ])²      |U + hold| ≤ limit

The cost is convex and has a continuous slope, so a Newton step of the present interval points downwards, and the best
point on it is found exactly: the slope along it is piecewise linear. Every plan on the way keeps the limit and costs
less than the one before. So the search may be stopped anywhere.

Source: Nocedal & Wright 2006, Numerical Optimization, section 16.7 (bounds); Hintermüller, Ito & Kunisch 2002, SIAM J.
Optimization 13, 865–888 (Newton steps on intervals).
"""

from __future__ import annotations

from numba import types

from ..jit import njit
from .layout import (
    CHANGE,
    COST,
    DIRECTION,
    FACTOR,
    FIXED,
    GRADIENT,
    HESSIAN,
    LEAST,
    LINEAR,
    MOVES,
    POINT,
    RESULT,
    ROW_HIGH,
    ROW_HIGH_WEIGHT,
    ROW_LOW,
    ROW_LOW_WEIGHT,
    ROW_MOVES,
    ROW_SIGNALS,
    ROWS,
    SIGNALS,
    SLOPE,
    VALUE,
)

_ARRAY = types.float64[::1]
_NUMBER, _WHOLE = types.float64, types.int64

#: A step that would lower the cost by less than this share of it ends the search (numerics).
ENOUGH = 1e-12


@njit(_NUMBER(_NUMBER, _NUMBER, _NUMBER), cache=True)
def outside(value, low, high):
    """How far a value is beyond its bounds, with the sign of the side."""
    return value - high if value > high else (value - low if value < low else 0.0)


@njit(_NUMBER(_ARRAY, _WHOLE, _NUMBER), cache=True)
def push(q, r, over):
    """Slope of the cost of a row that is so far beyond its bounds."""
    return over * (q[ROW_HIGH_WEIGHT + r] if over > 0.0 else q[ROW_LOW_WEIGHT + r])


@njit(_NUMBER(_ARRAY, _ARRAY), cache=True)
def form(matrix, signals):
    """½ ξᵀ Q ξ."""
    total = 0.0
    for i in range(SIGNALS):
        row = 0.0
        for j in range(SIGNALS):
            row += matrix[i * SIGNALS + j] * signals[j]
        total += row * signals[i]
    return 0.5 * total


@njit(_WHOLE(_ARRAY, _ARRAY, _NUMBER, _NUMBER, _ARRAY, _ARRAY), cache=True)
def begin(q, signals, hold, limit, plan, s):
    """The program at the signals, and the plan to start from, clipped."""
    for i in range(MOVES):
        linear = 0.0
        for j in range(SIGNALS):
            linear += q[GRADIENT + i * SIGNALS + j] * signals[j]
        s[LINEAR + i] = linear
        torque = plan[i]
        s[FIXED + i] = 1.0 if torque >= limit else (-1.0 if torque <= -limit else 0.0)
        s[POINT + i] = (limit if torque >= limit else (-limit if torque <= -limit else torque)) - hold
    for r in range(ROWS):
        value = 0.0
        for j in range(SIGNALS):
            value += q[ROW_SIGNALS + r * SIGNALS + j] * signals[j]
        for i in range(MOVES):
            value += q[ROW_MOVES + r * MOVES + i] * s[POINT + i]
        s[VALUE + r] = value
    return 0


@njit(_NUMBER(_ARRAY, _ARRAY), cache=True)
def slopes(q, s):
    """The slope of the cost at the point; the cost without that of the plan 0."""
    cost = 0.0
    for i in range(MOVES):
        curved = 0.0
        for j in range(MOVES):
            curved += q[HESSIAN + i * MOVES + j] * s[POINT + j]
        cost += (0.5 * curved + s[LINEAR + i]) * s[POINT + i]
        s[SLOPE + i] = curved + s[LINEAR + i]
    for r in range(ROWS):
        over = outside(s[VALUE + r], q[ROW_LOW + r], q[ROW_HIGH + r])
        if over != 0.0:
            pushing = push(q, r, over)
            cost += 0.5 * pushing * over
            for i in range(MOVES):
                s[SLOPE + i] += pushing * q[ROW_MOVES + r * MOVES + i]
    return cost


@njit(_WHOLE(_ARRAY, _ARRAY), cache=True)
def newton_direction(q, s):
    """The step to the least cost of this interval, in the free moves alone: L D Lᵀ, inverse D on the diagonal."""
    for i in range(MOVES):
        for j in range(i + 1):
            s[FACTOR + i * MOVES + j] = q[HESSIAN + i * MOVES + j]
    for r in range(ROWS):
        over = outside(s[VALUE + r], q[ROW_LOW + r], q[ROW_HIGH + r])
        if over != 0.0:
            weight = q[ROW_HIGH_WEIGHT + r] if over > 0.0 else q[ROW_LOW_WEIGHT + r]
            for i in range(MOVES):
                part = weight * q[ROW_MOVES + r * MOVES + i]
                for j in range(i + 1):
                    s[FACTOR + i * MOVES + j] += part * q[ROW_MOVES + r * MOVES + j]
    for i in range(MOVES):
        s[DIRECTION + i] = 0.0
        if s[FIXED + i] == 0.0:
            value = -s[SLOPE + i]
            pivot = s[FACTOR + i * MOVES + i]
            for j in range(i):
                if s[FIXED + j] == 0.0:
                    entry = s[FACTOR + i * MOVES + j]
                    for k in range(j):
                        if s[FIXED + k] == 0.0:
                            entry -= s[FACTOR + i * MOVES + k] * s[FACTOR + j * MOVES + k]
                    s[FACTOR + i * MOVES + j] = entry
            for j in range(i):
                if s[FIXED + j] == 0.0:
                    entry = s[FACTOR + i * MOVES + j]
                    scaled = entry * s[FACTOR + j * MOVES + j]
                    pivot -= entry * scaled
                    value -= scaled * s[DIRECTION + j]
                    s[FACTOR + i * MOVES + j] = scaled
            s[FACTOR + i * MOVES + i] = 1.0 / pivot
            s[DIRECTION + i] = value
    for back in range(MOVES):
        i = MOVES - 1 - back
        if s[FIXED + i] == 0.0:
            value = s[DIRECTION + i] * s[FACTOR + i * MOVES + i]
            for j in range(i + 1, MOVES):
                if s[FIXED + j] == 0.0:
                    value -= s[FACTOR + j * MOVES + i] * s[DIRECTION + j]
            s[DIRECTION + i] = value
    return 0


@njit(_NUMBER(_ARRAY, _NUMBER, _NUMBER, _ARRAY), cache=True)
def slope_along(q, start, curvature, s):
    """The slope of the cost along the direction after the share ``start`` of it; ``SLOPE`` and ``VALUE`` are those at
    its beginning, ``curvature`` that of the cost without its rows."""
    slope = curvature * start
    for i in range(MOVES):
        slope += s[SLOPE + i] * s[DIRECTION + i]
    for r in range(ROWS):
        low, high, now = q[ROW_LOW + r], q[ROW_HIGH + r], s[VALUE + r]
        there = now + start * s[CHANGE + r]
        slope += s[CHANGE + r] * (push(q, r, outside(there, low, high)) - push(q, r, outside(now, low, high)))
    return slope


@njit(_NUMBER(_ARRAY, _NUMBER, _ARRAY), cache=True)
def best_share(q, most, s):
    """The share of the direction, at most ``most``, after which the cost is least."""
    curvature = 0.0
    for i in range(MOVES):
        row = 0.0
        for j in range(MOVES):
            row += q[HESSIAN + i * MOVES + j] * s[DIRECTION + j]
        curvature += row * s[DIRECTION + i]
    high_slope = slope_along(q, most, curvature, s)
    if high_slope <= 0.0:
        return most
    low, low_slope, high = 0.0, slope_along(q, 0.0, curvature, s), most
    if low_slope >= 0.0:
        # Rounding alone: the slope at the start is that of a way down.
        return 0.0
    for r in range(ROWS):
        if s[CHANGE + r] != 0.0:
            for side in range(2):
                bound = q[ROW_LOW + r] if side == 0 else q[ROW_HIGH + r]
                kink = (bound - s[VALUE + r]) / s[CHANGE + r]
                if low < kink < high:
                    slope = slope_along(q, kink, curvature, s)
                    if slope <= 0.0:
                        low, low_slope = kink, slope
                    else:
                        high, high_slope = kink, slope
    return low + (high - low) * (low_slope / (low_slope - high_slope))


@njit(_NUMBER(_ARRAY, _NUMBER, _NUMBER, _ARRAY), cache=True)
def move_along(q, hold, limit, s):
    """Goes along the direction to the least cost within the limit; the share of it."""
    for r in range(ROWS):
        change = 0.0
        for i in range(MOVES):
            change += q[ROW_MOVES + r * MOVES + i] * s[DIRECTION + i]
        s[CHANGE + r] = change
    most, blocking, side = 1.0, -1, 0.0
    for i in range(MOVES):
        step = s[DIRECTION + i]
        if step != 0.0:
            sign = 1.0 if step > 0.0 else -1.0
            share = (sign * limit - hold - s[POINT + i]) / step
            if share < most:
                most, blocking, side = share, i, sign
    share = best_share(q, most if most > 0.0 else 0.0, s)
    for i in range(MOVES):
        s[POINT + i] += share * s[DIRECTION + i]
    for r in range(ROWS):
        s[VALUE + r] += share * s[CHANGE + r]
    if blocking >= 0 and share >= most:
        s[POINT + blocking] = side * limit - hold
        s[FIXED + blocking] = side
    return share


@njit(_WHOLE(_ARRAY), cache=True)
def release(s):
    """Frees the move at the limit that the cost draws back most; 0 where none is drawn."""
    worst, found = 0.0, -1
    for i in range(MOVES):
        pull = s[FIXED + i] * s[SLOPE + i]
        if pull > worst:
            worst, found = pull, i
    if found < 0:
        return 0
    s[FIXED + found] = 0.0
    return 1


@njit(_WHOLE(_ARRAY, _ARRAY, _NUMBER, _NUMBER, _ARRAY, _ARRAY, _WHOLE), cache=True)
def solve(q, signals, hold, limit, plan, s, most):
    """Betters the plan (Nm) in at most ``most`` steps; their number. ``s[RESULT]`` is the cost of the plan."""
    begin(q, signals, hold, limit, plan, s)
    offset = form(q[COST:LEAST], signals)
    cost = slopes(q, s) + offset
    used = 0
    searching = 1
    while searching == 1 and used < most:
        newton_direction(q, s)
        gain = 0.0
        for i in range(MOVES):
            gain -= s[SLOPE + i] * s[DIRECTION + i]
        used += 1
        if gain > ENOUGH * cost:
            move_along(q, hold, limit, s)
            cost = slopes(q, s) + offset
        else:
            searching = release(s)
    for i in range(MOVES):
        # At the limit to the last bit, so that the next search starts with the move fixed.
        torque = s[FIXED + i] * limit if s[FIXED + i] != 0.0 else s[POINT + i] + hold
        plan[i] = limit if torque > limit else (-limit if torque < -limit else torque)
    s[RESULT] = cost
    return used

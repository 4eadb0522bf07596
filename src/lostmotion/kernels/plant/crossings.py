"""First crossing of a bound by a polynomial: steps that can be shown never to jump over a root."""

from __future__ import annotations

import numpy as np

from ..jit import njit
from ..numerics.vectors import read
from .layout import INNER

#: Smallest step of the root search as a fraction of a sub-step: a few units of rounding of the time itself (numerics).
SMALLEST_STEP = 2.0**-50


@njit(forceinline=True, **INNER)
def _evaluate(p, order, t):
    """Polynomial with coefficients p at t: its Taylor coefficients of order 0 to 3 there."""
    q = read(p, order)
    q1 = 0.0
    q2 = 0.0
    q3 = 0.0
    for k in range(order - 1, -1, -1):
        q3 = q3 * t + q2
        q2 = q2 * t + q1
        q1 = q1 * t + q
        q = q * t + read(p, k)
    return q, q1, q2, q3


@njit(forceinline=True, **INNER)
def _reversed(q, q1, q2, q3):
    """Root of q + q1·t + q2·t² + q3·t³ by the reversed series up to order three, and what its last term does to q."""
    inverse = 1.0 / q1
    u = -q * inverse
    a = q2 * inverse
    last = u * u * u * (2.0 * a * a - q3 * inverse)
    return u - a * u * u + last, abs(q1 * last)


@njit(forceinline=True, **INNER)
def _only_crossing(p, order, sign, bound, until, tolerance):
    """The root of a monotone polynomial: by reversed series, by halves where those lead out of the bracket."""
    t, _ = _reversed(read(p, 0) - bound, read(p, 1), read(p, 2), read(p, 3))
    low, high = 0.0, until
    for _ in range(100):
        if not low <= t <= high:
            t = 0.5 * (low + high)
        q, q1, q2, q3 = _evaluate(p, order, t)
        q -= bound
        step, last = _reversed(q, q1, q2, q3)
        if sign * q > 0.0:
            low = t
        else:
            high = t
        t += step
        if last <= tolerance:
            break
    return min(max(t, 0.0), until)


@njit(**INNER)
def _stepped_crossing(p, order, sign, bound, until, tolerance):
    """As `first_crossing`: each step ends before the first root of a quadratic that lies below q."""
    third = 0.0  # bounds the third derivative
    for k in range(3, order + 1):
        third += k * (k - 1.0) * (k - 2.0) * abs(read(p, k))
    t = 0.0
    smallest = SMALLEST_STEP
    while True:
        q, q1, q2, _ = _evaluate(p, order, t)
        q = sign * (q - bound)
        q1 *= sign
        q2 *= 2.0 * sign
        if q < -tolerance:
            return t
        left = until - t
        if left <= 0.0:
            return 2.0
        curvature = q2 - third * left
        if curvature >= 0.0 and q1 >= 0.0:
            return 2.0
        q = max(q, 0.0)
        square = q1 * q1 - 2.0 * curvature * q
        if square < 0.0:
            return 2.0
        if q1 < 0.0:
            step = 2.0 * q / (-q1 + np.sqrt(square))
        else:
            step = (q1 + np.sqrt(square)) / -curvature
        if step >= left:
            # The bound holds up to the end; the end itself may lie on the wrong side by rounding only.
            return 2.0
        if step < smallest:
            step = smallest
            smallest *= 2.0
        t += step


@njit(forceinline=True, **INNER)
def first_crossing(p, order, sign, bound, until, bend, tolerance):
    """First time in [0, until] at which q = sign·(p − bound) goes below zero; 2.0 if it does not.

    p: address of the polynomial's coefficients on the normalised sub-step [0, 1]; bend: bounds how much the slope
    changes there; tolerance: rounding of q. A monotone q has one root at most; otherwise the steps jump over none.
    """
    q = sign * (read(p, 0) - bound)
    slope = sign * read(p, 1)
    change = bend * until
    if q < -tolerance or abs(slope) <= change:
        return _stepped_crossing(p, order, sign, bound, until, tolerance)
    if slope > 0.0:
        return 2.0
    if q + (slope + change) * until >= -tolerance:
        end, _, _, _ = _evaluate(p, order, until)
        if sign * (end - bound) >= -tolerance:
            return 2.0
    return _only_crossing(p, order, sign, bound, until, tolerance)

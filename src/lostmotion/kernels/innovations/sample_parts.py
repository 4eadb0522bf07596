"""Parts of a sample: which have a transition, and what the torque does in them.

A sample has 2ᶠⁱⁿᵉˢᵗ finest parts. Transitions are kept over the whole sample, over 1 to 7 of the finest parts, 1 to 7
times eight of them, and so on: so any part of a sample is at most three of them long, and a change in it is found in
three times three halvings.
"""

from __future__ import annotations

from ..jit import njit
from .columns import INNER

#: A length is one octal digit: its bits, and its largest value (layout).
DIGIT, MOST = 3, 7


@njit(forceinline=True, **INNER)
def parts(finest):
    """How many have a transition."""
    return 1 + MOST * ((finest + DIGIT - 1) // DIGIT)


@njit(forceinline=True, **INNER)
def part_number(size, finest):
    """Which of them, the whole sample first, is ``size`` finest parts long; see ``part_within``."""
    if size == 1 << finest:
        return 0
    first = 0
    while size > MOST:
        size >>= DIGIT
        first += MOST
    return first + size


@njit(forceinline=True, **INNER)
def part_within(size, finest):
    """The longest that is no longer than ``size`` finest parts."""
    digit = 0
    while (size >> digit) > MOST and size < 1 << finest:
        digit += DIGIT
    return size >> digit << digit


@njit(**INNER)
def shape_mean(part, finest, done, size):
    """Mean over a part of what a torque within a sample differs from its mean by; done and size in finest parts.

    A held torque changes after ``part`` of the sample: 1 before, 0 after, less the mean. A ramp (part < 0) falls from
    0.5 to −0.5.
    """
    whole = 1 << finest
    if part < 0.0:
        return 0.5 - (done + 0.5 * size) / whole
    return min(max((part * whole - done) / size, 0.0), 1.0) - part


@njit(forceinline=True, **INNER)
def until_change(part, finest, done):
    """Finest parts from ``done`` until a held torque changes, the one in which it does alone, or the sample ends."""
    change, end = part * (1 << finest), 1 << finest
    if done < change < end:
        return max(int(change) - done, 1)
    return end - done

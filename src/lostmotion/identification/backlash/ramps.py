"""Usable rows of the test with the load locked: the torque's ramps, the flank in contact, the encoder count."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..friction.result import Floats

# Calibrated on the virtual rigs 1 to 4 with the load locked, 12 and 16 bit: with half or double of any of the four the
# largest error of the backlash is 0.8 to 0.9 % (benchmarks/calibrations.py).

#: Torque reversals smaller than this part of its range count as noise (calibrated, as all four).
REVERSAL = 0.05
#: Left out on both sides of a crossing and of the end of sticking, as part of the torque's range (calibrated, as all).
CLEARANCE = 0.02
#: Jumps of the torque by this part of its range within a sample are steps, after which the motor oscillates
#: (calibrated, as all).
JUMP = 0.02
#: The angle oscillates where it varies by this many times the usual amount within the settling time (calibrated, as
#: all).
SWING = 2.0


def count_of(theta: Floats) -> float:
    """The encoder's count, if all changes are multiples of the smallest one; else 0."""
    steps = np.abs(np.diff(np.unique(theta)))
    steps = steps[steps > 1e-12 * max(float(np.abs(theta).max()), 1e-300)]
    if not steps.size:
        return 0.0
    # Rounding spoils the smallest step; the mean of all that are one count has its digits.
    count = float(steps[steps < 1.5 * steps.min()].mean())
    multiples = steps / count
    return count if float(np.abs(multiples - np.round(multiples)).max()) < 1e-3 else 0.0


def ramps_of(m: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Direction of the torque (±1) and number of the ramp for each row; reversals within noise do not count."""
    least = REVERSAL * float(np.ptp(m))
    direction, ramp = np.empty(m.size), np.empty(m.size, dtype=np.int64)
    way = 1.0 if float(m[int(np.argmax(np.abs(m - m[0]) > least))]) >= float(m[0]) else -1.0
    extreme, at, start, number = float(m[0]), 0, 0, 0
    for k, value in enumerate(m.tolist()):
        if way * (value - extreme) >= 0.0:
            extreme, at = value, k
        elif way * (extreme - value) > least:
            direction[start : at + 1], ramp[start : at + 1] = way, number
            way, start, number, extreme, at = -way, at + 1, number + 1, value, k
    direction[start:], ramp[start:] = way, number
    return direction, ramp


def sides_of(
    m: Floats, theta: Floats, direction: Floats, ramp: NDArray[np.int64], settling: int, count: float
) -> Floats:
    """Flank in contact, ±1, for the rows that can be used; else 0."""
    clear = CLEARANCE * float(np.ptp(m))
    side = np.where(theta >= 0.0, 1.0, -1.0)
    crossings = np.flatnonzero(np.diff(side)) + 1
    friction = _friction(m, direction, crossings)
    use = np.ones(m.size, dtype=bool)
    for number in range(int(ramp.max()) + 1):
        rows = np.flatnonzero(ramp == number)
        start = m[rows[0]]
        # After a reversal the motor's friction reverses before the motor moves. The first ramp starts anywhere.
        held = 2.2 * friction + clear
        use[rows] &= direction[rows] * (m[rows] - start) > held
    for k in crossings:
        near = slice(max(k - settling // 4, 0), k + settling)
        use[near] = False
        same = ramp == ramp[k]
        use[same & (np.abs(m - m[k]) < clear)] = False
    for k in np.flatnonzero(np.abs(np.diff(m)) > JUMP * float(np.ptp(m))) + 1:
        use[k : k + settling] = False
    use &= _quiet(theta, use, settling, count)
    return np.where(use, side, 0.0)


def _quiet(theta: Floats, use: NDArray[np.bool_], width: int, count: float) -> NDArray[np.bool_]:
    """Where the motor does not oscillate: with little friction it bounces for longer than the settling time."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    swing = maximum_filter1d(theta, width) - minimum_filter1d(theta, width)
    usual = float(np.median(swing[use])) if use.any() else 0.0
    return np.asarray(swing < SWING * usual + 1.5 * count)


def _friction(m: Floats, direction: Floats, crossings: NDArray[np.int64]) -> float:
    """Coulomb friction at the motor, Nm: the gap is crossed where the torque exceeds it."""
    up, down = (m[crossings[direction[crossings] == way]] for way in (1.0, -1.0))
    if not (up.size and down.size):
        return 0.0
    return max(0.5 * (float(np.median(up)) - float(np.median(down))), 0.0)

"""How motor torque and motor speed go together: what tells a wrong sign, swapped columns, and a wrong unit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...recording import Recording

Array = NDArray[np.float64]

#: Shortest blocks over which torque and speed are averaged, s, and how many are needed. Calibrated on rigs 1 to 4,
#: where the correlation of a right recording is 0.13 with blocks of 2.5 ms, 0.23 with 10 ms, 0.88 with 25 ms, and on
#: measured drives (recordings not noted), which give 0.46 to 1.
BLOCK, FEWEST_BLOCKS = 0.025, 40
#: Further blocks, times the shortest: a slow axis of 52 kg m2 with its mode at 20 Hz gives -0.08 with 25 ms and 0.98
#: with 200 ms. The longest whose correlation is near the largest shows the inertia of motor and load together (option).
LONGER, NEAR = (1, 2, 4, 8, 16), 0.9
#: Least correlation of torque and acceleration, either way, that shows an inertia (option: the inertia is then within
#: a factor of two).
CORRELATED = 0.5
#: Blocks from which on, and standard deviations of independent ones (1/√blocks) within which, torque and speed have
#: nothing to do with each other (option: ten such correlations are all within 3.5 in 995 of 1000 cases).
MANY_BLOCKS, CHANCE = 200, 3.5


def column_order(recording: Recording) -> tuple[float, float]:
    """How well changes of the motor's speed follow its torque, and the torque's the speed: correlations, or 0, 0.

    Means over blocks are compared, which hold little noise of an encoder, and little of a shaft that swings: the
    shortest that show either of the two, for over long ones a sine goes through. The followed signal's own part, as of
    friction, is taken out. Over torques of many frequencies the first is near 1, the second near 0; a sine, and a
    controller's answer, follow each other both ways.
    """
    both = [(_following(*means), _following(*means[::-1])) for _, means in _blocks(recording)]
    shown = [pair for pair in both if max(map(abs, pair)) > CORRELATED]
    return (*shown, *both, (0.0, 0.0))[0]


def inertia_shown(recording: Recording) -> float | None:
    """Inertia that the motor's speed shows under its torque, kg m2, negative where it turns the other way.

    Over means of blocks, as ``column_order``: the ratio of the standard deviations of torque and acceleration, for
    which noise of either counts alike. None where their correlation is below ``CORRELATED``.
    """
    told = [(_following(*means), step, means) for step, means in _blocks(recording)]
    best = max((abs(correlation) for correlation, _, _ in told), default=0.0)
    if best < CORRELATED:
        return None
    correlation, step, means = [one for one in told if abs(one[0]) >= NEAR * best][-1]
    force, change = (float(np.linalg.norm(rest)) for rest in _rests(*means))
    return math.copysign(force / change * step, correlation)


def shows_wrong_sign(recording: Recording) -> bool:
    """Whether the speed clearly follows the reversed torque, and the motor would give energy over the whole recording.

    The second cannot be where it drives nothing but inertia and friction, and tells a wrong sign from a torque between
    zero and pole, where a motor really turns against it.
    """
    if column_order(recording)[0] > -CORRELATED:
        return False
    return float(recording["torque_motor"] @ recording["speed_motor"]) < 0.0


def unrelated(recording: Recording) -> float | None:
    """The largest correlation of torque and speed, either way, where all are chance in a long recording; else None."""
    blocks = [means for _, means in _blocks(recording)]
    if not blocks or blocks[0][0].size < MANY_BLOCKS:
        return None
    both = [(abs(_following(*pair)), len(means[0])) for means in blocks for pair in (means, means[::-1])]
    return None if any(size > CHANCE / math.sqrt(count) for size, count in both) else max(both)[0]


def _blocks(recording: Recording) -> list[tuple[float, tuple[Array, Array]]]:
    """For every length of blocks of which there are enough: that length, s, and means of motor torque and speed."""
    if "torque_motor" not in recording or "speed_motor" not in recording:
        return []
    found = []
    for rows in (max(1, round(BLOCK * longer / recording.dt)) for longer in LONGER):
        blocks = len(recording) // rows
        if blocks >= FEWEST_BLOCKS:
            torque, speed = (
                recording[name][: blocks * rows].reshape(blocks, rows).mean(axis=1)
                for name in ("torque_motor", "speed_motor")
            )
            found.append((rows * recording.dt, (torque, speed)))
    return found


def _rests(cause: Array, followed: Array) -> tuple[Array, Array]:
    """Between two blocks each: the cause, and the change of what follows it, without what goes with its own size."""
    between, change = 0.5 * (followed[1:] + followed[:-1]), np.diff(followed)
    own = np.column_stack([np.ones_like(between), between, np.sign(between)])

    def rest(values: Array) -> Array:
        return np.asarray(values - own @ np.linalg.lstsq(own, values, rcond=None)[0])

    return rest(0.5 * (cause[1:] + cause[:-1])), rest(change)


def _following(cause: Array, followed: Array) -> float:
    a, b = _rests(cause, followed)
    size = float(np.linalg.norm(a) * np.linalg.norm(b))
    return float(a @ b) / size if size > 0.0 else 0.0


def torque_agreement(recording: Recording) -> float:
    """Whether motor torque and motor acceleration point the same way, from −1 to 1; 0 if that is open.

    The mean cosine of the phase of acceleration against torque over all frequencies where both are coherent
    (> 0.5), weighted by coherence and on a logarithmic frequency axis. An inertia gives 1. A shaft between
    zero and pole turns the phase by half a turn, and so does a load against the controller at low frequency;
    neither fills most of the axis. With fewer than five such frequencies (a single step) nothing is said.
    """
    if "torque_motor" not in recording or "speed_motor" not in recording or len(recording) < 256:
        return 0.0
    from scipy.signal import csd, welch

    torque = recording["torque_motor"][:-1]
    acceleration = np.diff(recording["speed_motor"]) / recording.dt
    if np.ptp(torque) == 0.0 or np.ptp(acceleration) == 0.0:
        return 0.0
    # Sixteen half-overlapping segments or more keep the coherence of independent signals well below 0.5.
    size = max(64, min(4096, torque.size // 8))
    frequency, cross = csd(torque, acceleration, 1.0 / recording.dt, nperseg=size)
    power = (
        welch(torque, nperseg=size, fs=1.0 / recording.dt)[1]
        * welch(acceleration, nperseg=size, fs=1.0 / recording.dt)[1]
    )
    used = (frequency > 0.0) & (power > 0.0)
    cross, power, frequency = cross[used], power[used], frequency[used]
    coherence = np.abs(cross) ** 2 / power
    good = (coherence > 0.5) & (np.abs(cross) > 0.0)
    if np.count_nonzero(good) < 5:
        return 0.0
    weight = coherence[good] / frequency[good]
    return float(np.sum(weight * cross[good].real / np.abs(cross[good])) / np.sum(weight))

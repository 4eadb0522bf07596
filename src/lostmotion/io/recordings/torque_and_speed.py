"""How motor torque and motor speed go together: what tells a wrong sign, swapped columns, and a wrong unit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...recording import Recording

Array = NDArray[np.float64]

#: Blocks over which torque and speed are averaged, s, and how many are needed. Calibrated on rigs 1 to 4, where the
#: correlation of a right recording is 0.13 with blocks of 2.5 ms, 0.23 with 10 ms, 0.88 with 25 ms, and on measured
#: drives (recordings not noted), which give 0.46 to 1.
BLOCK, FEWEST_BLOCKS = 0.025, 40
#: Least correlation of torque and acceleration, either way, that shows an inertia (option: the inertia is then within
#: a factor of two).
CORRELATED = 0.5


def column_order(recording: Recording) -> tuple[float, float]:
    """How well changes of the motor's speed follow its torque, and the torque's the speed: correlations, or 0, 0.

    Means over blocks of `BLOCK` are compared, which hold little noise of an encoder. The followed signal's own part, as
    of friction, is taken out. Over torques of many frequencies the first is near 1, the second near 0; a sine, and a
    controller's answer, follow each other both ways.
    """
    means = _block_means(recording)
    return (0.0, 0.0) if means is None else (_following(*means), _following(*means[::-1]))


def inertia_shown(recording: Recording) -> float | None:
    """Inertia that the motor's speed shows under its torque, kg m2, negative where it turns the other way.

    Over means of blocks, as ``column_order``: the ratio of the standard deviations of torque and acceleration, for
    which noise of either counts alike. None where their correlation is below ``CORRELATED``.
    """
    means = _block_means(recording)
    correlation = 0.0 if means is None else _following(*means)
    if means is None or abs(correlation) < CORRELATED:
        return None
    force, change = (float(np.linalg.norm(rest)) for rest in _rests(*means))
    return math.copysign(force / change * max(1, round(BLOCK / recording.dt)) * recording.dt, correlation)


def _block_means(recording: Recording) -> tuple[Array, Array] | None:
    """Motor torque and speed, a row for each block; None where there are too few."""
    if "torque_motor" not in recording or "speed_motor" not in recording:
        return None
    rows = max(1, round(BLOCK / recording.dt))
    blocks = len(recording) // rows
    if blocks < FEWEST_BLOCKS:
        return None
    torque, speed = (
        recording[name][: blocks * rows].reshape(blocks, rows).mean(axis=1)
        for name in ("torque_motor", "speed_motor")
    )
    return torque, speed


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

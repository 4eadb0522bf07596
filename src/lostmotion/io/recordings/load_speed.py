"""Whether the load's speed is that of the load of this motor: turned the same way, behind no gear, at the same time."""

from __future__ import annotations

import numpy as np

from ...errors import Problem
from ...recording import Recording
from .torque_and_speed import BLOCK, FEWEST_BLOCKS

#: Least correlation of both speeds over means of blocks, and how far their ratio may be from one (options: a shaft that
#: swings and a gap take little of slow motion; rpm for rad/s and usual gears are far beyond).
CORRELATED, RATIO = 0.7, 1.5
#: Both turn by the same angle but for shaft and gap, which is at most this, rad; and sensors of a scale of their own
#: may differ by this share of the whole way (options: half a turn is no shaft's; a tachometer has 0.5 %).
WINDING, SENSOR = 1.0, 0.01
#: Motor and load are exchanged if, at so many frequencies at least where both turn against each other and are coherent
#: with the torque, the "motor" turns so many times less than the "load", and ever less (options: of three drives by a
#: plain integrator the ratio is 0.008 to 0.11 and falls with the power -1.1 to -2.3 of the frequency; two masses: -2).
#: Coherence with the torque of more than this counts (option: 16 half-overlapping segments keep chance below).
FEWEST_OPPOSITE, LESS, FALLS, COHERENT = 20, 3.0, 0.5, 0.3
#: A load that moves by less than this share of the motor's motion is held, as in the locked-load test (option).
LOCKED = 0.01


def check_load_speed(recording: Recording) -> tuple[Problem, ...]:
    """The warning that over means of 25 ms the load does not turn as fast as the motor."""
    if not {"speed_motor", "speed_load"} <= set(recording.signals):
        return ()
    rows = max(1, round(BLOCK / recording.dt))
    blocks = len(recording) // rows
    if blocks < FEWEST_BLOCKS:
        return ()
    motor, load = (
        recording[name][: blocks * rows].reshape(blocks, rows).mean(axis=1)
        for name in ("speed_motor", "speed_load")
    )
    sizes = float(np.linalg.norm(motor)), float(np.linalg.norm(load))
    if min(sizes) <= LOCKED * max(sizes):
        return ()
    correlation, ratio = float(motor @ load) / (sizes[0] * sizes[1]), sizes[0] / sizes[1]
    where = f"{recording.meta.get('file', 'recording')}, speed_load"
    if correlation > CORRELATED and 1.0 / RATIO < ratio < RATIO:
        return _exchanged(recording, where) or _drifting(recording, where)
    got = f"a load that turns {1.0 / ratio:.3g} times as fast as the motor (correlation {correlation:.2f})"
    if correlation < -CORRELATED:
        remedy = "It turns the other way: set sign = -1 for speed_load."
    elif correlation > CORRELATED:
        remedy = f"Check its unit. Behind a gear, give scale = {ratio:.4g}: all is referred to the motor."
    else:
        remedy = "Check that both were recorded at the same time, and the column."
    return (Problem.warning(where, got, "a load that turns with the motor, but for shaft and gap", remedy),)


def _drifting(recording: Recording, where: str) -> tuple[Problem, ...]:
    """The warning that motor and load turn by different angles: one of the speeds has an offset, or another scale."""
    motor, load = recording["speed_motor"], recording["speed_load"]
    twist = recording.dt * np.cumsum(motor - load)
    largest = float(np.ptp(twist))
    if largest <= max(WINDING, SENSOR * recording.dt * float(np.sum(np.abs(motor)))):
        return ()
    offset = float(np.mean(motor) - np.mean(load))
    got = f"a load that turns up to {largest:.3g} rad less or more than the motor, {abs(offset):.3g} rad/s in the mean"
    remedy = (
        "Correct the offset or the scale of one of them: offset = ... or scale = ... in its channel. Leave the load's "
        "speed out if neither is known."
    )
    return (Problem.warning(where, got, "the motor's angle, but for shaft and gap", remedy),)


def _exchanged(recording: Recording, where: str) -> tuple[Problem, ...]:
    """The warning that the torque acts on what is called the load.

    Above the zero of the motor the load turns against it, by 1/(1 − (ω/ω₀)²) as much: less and less.
    """
    if "torque_motor" not in recording or len(recording) < 64 * FEWEST_OPPOSITE:
        return ()
    from scipy.signal import csd, welch

    torque = recording["torque_motor"]
    size = max(64, min(4096, torque.size // 8))
    answers, coherent = [], np.ones(size // 2 + 1, dtype=bool)
    power = welch(torque, nperseg=size)[1]
    for name in ("speed_motor", "speed_load"):
        change = np.diff(recording[name], prepend=recording[name][0])
        frequency, cross = csd(torque, change, nperseg=size)
        coherent &= np.abs(cross) ** 2 > COHERENT * power * welch(change, nperseg=size)[1]
        answers.append(cross)
    coherent &= (frequency > 0.0) & (np.abs(answers[0]) > 0.0)
    ratio = answers[1][coherent] / answers[0][coherent]
    opposite = ratio.real < 0.0
    if np.count_nonzero(opposite) < FEWEST_OPPOSITE:
        return ()
    sizes = np.abs(ratio[opposite])
    slope = float(np.polyfit(np.log(frequency[coherent][opposite]), np.log(sizes), 1)[0])
    if np.median(sizes) < LESS or slope < FALLS:
        return ()
    got = f"a load that answers the motor's torque {np.median(sizes):.3g} times as much as the motor at high frequency"
    remedy = "The columns of both speeds look exchanged: exchange them in channels, or in the file's header."
    return (Problem.warning(where, got, "a motor that answers its torque first", remedy),)

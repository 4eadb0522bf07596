"""Which sample of a sensor an estimator uses: one that is missing, frozen, or a jump is not, see ``verdicts``.

The innovation is judged by its own standard deviation, that is by how well the estimate knows the signal (validation
gate: Bar-Shalom & Fortmann 1988, Tracking and Data Association).
"""

from __future__ import annotations

import math

from ..jit import njit
from .verdicts import FROZEN, JUMP, MISSING, START_AGAIN, USE

#: Numerics: an estimate beyond this is lost (SI units; far above any drivetrain), and the observer starts again.
LOST = 1e8

#: A value that came so often may be frozen. Numerics: two equal counts in a row are common.
REPEATS = 3.0
#: A value may stand still while the model has moved by less than so many of its smallest steps; smaller changes than
#: this share of a value are its rounding. Numerics: ``FROZEN_MOVE`` deviations of a count, 6/√6; eps with a margin.
STEPS, ROUNDING = 2.45, 1e-9

#: Rate at which standard deviations grow while samples are refused as frozen or jumps, 1/s. Calibration: the virtual
#: rigs 1 to 4, where the extended Kalman filter refuses a jump of 8 rad/s for 19.9 ms (benchmarks/calibrations.py).
REFUSED_RATE = 60.0


@njit(cache=True, inline="always")
def _repeated(p, i, memory, moved):
    """The same value again: FROZEN once the model has moved meanwhile, until it has come too often."""
    memory.repeats += 1.0
    memory.moved = LOST if memory.moved >= LOST else memory.moved + moved
    may_stand = max(p.still[i], STEPS * memory.resolution)
    if memory.repeats < REPEATS or not abs(memory.moved) > may_stand:
        return USE
    # Once frozen it stays so, also where the estimate comes past the value again.
    memory.moved = LOST
    if memory.repeats <= p.frozen_hold:
        return FROZEN
    memory.repeats = memory.moved = memory.refused = 0.0
    return START_AGAIN


@njit(cache=True, inline="always")
def _changed(memory, value):
    """Another value; the smallest step that it ever made is the sensor's resolution."""
    step = abs(value - memory.value)
    if step > ROUNDING * abs(value) and (step < memory.resolution or memory.resolution == 0.0):
        memory.resolution = step
    memory.value = value
    memory.repeats = 1.0
    memory.moved = 0.0


@njit(cache=True, inline="always")
def _gated(p, i, memory, innovation, variance):
    """USE an innovation within the gate; others are a JUMP, until too many in a row were."""
    if abs(innovation) <= p.gate * math.sqrt(variance) + p.mismatch[i]:
        memory.refused = 0.0
        return USE
    memory.refused += 1.0
    if memory.refused > p.hold:
        memory.refused = 0.0
        return START_AGAIN
    return JUMP


@njit(cache=True, inline="always")
def check_sample(p, i, memory, value, missing, moved, innovation, variance):
    """What is done with a sample of sensor ``i``; keeps the sensor's memory.

    Missing samples are not used. A frozen one is not: the very same value again, while the model alone has moved by
    more than ``still`` since it came first, and from then on until it changes. A jump is not: an innovation beyond
    ``gate`` times its own deviation plus what the model's own error may add, ``mismatch``. But after ``hold`` jumps in
    a row, or a value that came ``frozen_hold`` times, the signal counts as right and the estimate as lost.

    Parameters
    ----------
    value, moved : float
        The sample, and the change of the predicted signal over the last sample by the model alone, as measured.
    innovation, variance : float
        Times ``scale`` and its square: of the angle turned if the speed comes from counts.

    Returns
    -------
    int
        USE, MISSING, FROZEN, JUMP (predict through these) or START_AGAIN.
    """
    if missing:
        memory.moved += moved
        return MISSING
    if value != memory.value:
        _changed(memory, value)
    else:
        verdict = _repeated(p, i, memory, moved)
        if verdict != USE:
            return verdict
    return _gated(p, i, memory, innovation, variance)

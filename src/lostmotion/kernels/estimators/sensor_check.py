"""Which sample of a sensor an estimator uses: one that is missing, frozen, or a jump is not, see ``verdicts``.

The innovation is judged by its own standard deviation, that is by how well the estimate knows the signal (validation
gate: Bar-Shalom & Fortmann 1988, Tracking and Data Association).
"""

from __future__ import annotations

import math

from ..jit import njit
from .verdicts import FROZEN, JUMP, MISSING, START_AGAIN, USE

#: What a sensor measures: its ``kind``.
OF_SPEED_MOTOR, OF_SPEED_LOAD, OF_TWIST, OF_TORQUE_SHAFT = 0, 1, 2, 3

#: An estimate beyond this is lost (SI units; chosen far above any drivetrain), and the observer starts again.
LOST = 1e8

#: A value that came so often is frozen if the model has moved meanwhile (chosen: two equal counts are common).
REPEATS = 3.0
#: A value stands still if the model has moved by less than so many of its smallest steps (chosen: ``tuning.FREEZE``
#: deviations of a count); smaller changes than this share of a value are its rounding.
STEPS, ROUNDING = 2.45, 1e-9

#: Rate at which standard deviations grow while samples are refused as frozen or jumps, 1/s (chosen).
REFUSED_RATE = 60.0

_ROOT_SIXTH = math.sqrt(1.0 / 6.0)


@njit(cache=True, inline="always")
def sensor_variance(p, i, memory):
    """Variance R of sensor ``i``, times ``scale`` squared; at least that of its resolution, step²/12.

    An encoder coarser than was said shows itself by its steps, in the first few of them.
    """
    step = memory.resolution * p.scale[i]
    return max(p.R[i], step * step / 12.0)


@njit(cache=True, inline="always")
def deviation_of_counts(memory):
    """Standard deviation of a speed that is a difference of counts, by its resolution."""
    return memory.resolution * _ROOT_SIXTH


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
    if value == memory.value:
        memory.repeats += 1.0
        memory.moved = LOST if memory.moved >= LOST else memory.moved + moved
        stands = max(p.still[i], STEPS * memory.resolution)
        if memory.repeats >= REPEATS and abs(memory.moved) > stands:
            # Once frozen it stays so, also where the estimate comes past the value again.
            memory.moved = LOST
            if memory.repeats <= p.frozen_hold:
                return FROZEN
            memory.repeats = memory.moved = memory.refused = 0.0
            return START_AGAIN
    else:
        step = abs(value - memory.value)
        if step > ROUNDING * abs(value) and (step < memory.resolution or memory.resolution == 0.0):
            memory.resolution = step
        memory.value = value
        memory.repeats = 1.0
        memory.moved = 0.0
    if abs(innovation) <= p.gate * math.sqrt(variance) + p.mismatch[i]:
        memory.refused = 0.0
        return USE
    memory.refused += 1.0
    if memory.refused > p.hold:
        memory.refused = 0.0
        return START_AGAIN
    return JUMP

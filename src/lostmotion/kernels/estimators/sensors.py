"""What a sensor shows, how well, and from where on an encoder counts."""

from __future__ import annotations

import math

from ..jit import njit
from .layout import ANGLE_COUNTED, SPEED_LOAD, SPEED_MOTOR, TWIST

#: What a sensor measures: its ``kind``.
OF_SPEED_MOTOR, OF_SPEED_LOAD, OF_TWIST, OF_TORQUE_SHAFT = 0, 1, 2, 3

#: Numerics: the difference of two readings that are each uniform within a count.
_ROOT_SIXTH = math.sqrt(1.0 / 6.0)


@njit(cache=True, inline="always")
def state_shown(kind):
    """The state that a sensor shows, of a shaft torque that from which it winds."""
    return SPEED_MOTOR if kind == OF_SPEED_MOTOR else SPEED_LOAD if kind == OF_SPEED_LOAD else TWIST


@njit(cache=True, inline="always")
def state_measured(p, kind):
    """The same as it is filtered: a motor speed from counts by the angle turned."""
    return ANGLE_COUNTED if kind == OF_SPEED_MOTOR and p.counted else state_shown(kind)


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
def count_from_here(x, P, turned, R, used):
    """After the encoder counted: the counted angle is measured from the newest count on.

    A used sample moves it by what was counted, ``turned``. Otherwise the count is not known: the angle is then its
    error alone, white noise of the variance R.
    """
    if used:
        x[ANGLE_COUNTED] -= turned
        return
    x[ANGLE_COUNTED] = 0.0
    for j in range(x.size):
        P[ANGLE_COUNTED, j] = P[j, ANGLE_COUNTED] = 0.0
    P[ANGLE_COUNTED, ANGLE_COUNTED] = R

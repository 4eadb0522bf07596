"""What the observers with one sensor, the motor speed, share: start, the innovation that is believed, outputs.

See ``steppers_model`` for the model and for numba's cache.
"""

from __future__ import annotations

import math

from numba import njit

from .steppers_model import (
    HOLD,
    LEAD_MIDDLE,
    LOST,
    MEAN_BEFORE,
    MEAN_NOW,
    MEMORY,
    OWN,
    RATIO_MINUS,
    RATIO_PLUS,
    START,
    START_AGAIN,
    USE,
    VARIANCE,
    advance,
    clip,
    sensor_believed,
    torque_believed,
    write_estimates,
)  # fmt: skip

# Own parameters: half of the backlash, Coulomb level; largest innovation expected, and its growth per sample without
# a believed measurement, both over the gate.
HALF, COULOMB, EXPECTED, GROWTH = OWN, OWN + 1, OWN + 2, OWN + 3
FREE = OWN + 4

# Places in the state: twist, speed_motor, speed_load, torque_actuator, speed_motor_previous, then
PREVIOUS, STARTED, TORQUE, FRICTION, MOVED, UNBELIEVED, SENSOR = 4, 5, 6, 7, 8, 9, 10
SIZE = SENSOR + MEMORY


@njit(cache=True, inline="always")
def restart(p, s, speed):
    """Both inertias at ``speed``, in the middle of the gap."""
    s[0] = p[START]
    s[1] = s[2] = s[PREVIOUS] = speed
    s[3] = s[TORQUE]
    s[FRICTION] = s[MOVED] = s[UNBELIEVED] = 0.0
    s[STARTED] = 1.0


@njit(cache=True, inline="always")
def innovation_of(p, s, inputs, faults):
    """Torque to use, innovation (0 where the speed is not believed), faults."""
    torque, faults = torque_believed(p, s, TORQUE, inputs, faults)
    speed = inputs[1]
    missing = faults & 2 != 0
    if s[STARTED] == 0.0:
        restart(p, s, 0.0 if missing else speed)
    innovation = speed - p[MEAN_NOW] * s[1] - p[MEAN_BEFORE] * s[PREVIOUS]
    expected = p[EXPECTED] + p[GROWTH] * s[UNBELIEVED]
    verdict = sensor_believed(
        p, s, SENSOR, speed, missing, s[MOVED], innovation, expected * expected, math.sqrt(p[VARIANCE])
    )
    if verdict == START_AGAIN:
        restart(p, s, speed)
    if verdict != USE:
        s[UNBELIEVED] = min(s[UNBELIEVED] + 1.0, p[HOLD])
        return torque, 0.0, faults | 2
    s[UNBELIEVED] = 0.0
    return torque, innovation, faults


@njit(cache=True, inline="always")
def outputs_of(p, s, outputs):
    write_estimates(p, s[0], s[1], s[2], p[HALF], s[FRICTION], outputs)


@njit(cache=True, inline="always")
def correct(p, s, torque, twist, motor, load):
    """One sample of the model, then the corrections; those of twist and load only where the motor can feel them.

    In the gap the motor speed says nothing about them, and a load that sticks needs none.
    """
    z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
    gap = clip(z, -p[HALF], p[HALF])
    n0, n1, n2, n3, _, friction = advance(p, s[0], s[1], s[2], s[3], 0.0, p[COULOMB], gap, torque)
    s[MOVED] = n1 - s[1]
    s[PREVIOUS] = s[1]
    if abs(z) > p[HALF]:
        n0 += twist
        if abs(friction) >= p[COULOMB] * min(p[RATIO_PLUS], p[RATIO_MINUS]):
            n2 += load
    s[0], s[1], s[2], s[3], s[FRICTION] = n0, n1 + motor, n2, n3, friction
    if not (abs(s[0]) < LOST and abs(s[1]) < LOST and abs(s[2]) < LOST and abs(s[3]) < LOST):
        restart(p, s, 0.0)
        s[STARTED] = 0.0
        return True
    return False

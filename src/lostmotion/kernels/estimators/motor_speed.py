"""What the observers with one sensor, the motor speed, share: start, the innovation that is believed, outputs.

See ``two_mass_model`` for the model and for numba's cache.
"""

from __future__ import annotations

from numba import njit

from .two_mass_model import (
    ANGLE,
    AVERAGED,
    DT,
    FROZEN,
    GATE,
    HOLD,
    LEAD_MIDDLE,
    LOST,
    MEMORY,
    MISSING_TORQUE,
    OWN,
    PIECES,
    RATIO_MINUS,
    RATIO_PLUS,
    START,
    START_AGAIN,
    USE,
    advance,
    clip,
    deviation_of_steps,
    sensor_believed,
    torque_believed,
    write_estimates,
)  # fmt: skip

# Own parameters: half of the backlash, Coulomb level; largest innovation expected, and its growth per sample without
# a believed measurement, both over the gate; the sensor's deviation as told, and how much that of its steps adds.
HALF, COULOMB, EXPECTED, GROWTH, NOISE, COARSER = OWN, OWN + 1, OWN + 2, OWN + 3, OWN + 4, OWN + 5
FREE = OWN + 6

# Places in the state: those of ``two_mass_model``, then (BLIND: samples without torque and speed, which fade by FADE)
STARTED, TORQUE, FRICTION, MOVED, UNBELIEVED, GIVEN, BLIND, SENSOR = 5, 6, 7, 8, 9, 10, 11, 12
SIZE = SENSOR + MEMORY


#: Each sample that is there again makes up for so many in which torque and speed were missing (chosen on rigs 1 to 4).
FADE = 0.25
#: Shares of the hold time: what is less does no harm; while more is left, nobody knows the side of the gap (chosen on
#: rigs 1 to 4).
SHORT, UNSURE = 0.1, 0.33


@njit(cache=True, inline="always")
def restart(p, s, speed):
    """Both inertias at ``speed``, in the middle of the gap."""
    s[0] = p[START]
    s[1] = s[2] = speed
    s[3] = s[TORQUE]
    s[ANGLE] = speed * p[DT]
    s[FRICTION] = s[MOVED] = s[UNBELIEVED] = s[GIVEN] = s[BLIND] = 0.0
    s[STARTED] = 1.0


@njit(cache=True, inline="always")
def innovation_of(p, s, inputs, faults):
    """Torque to use, innovation (0 where the speed is not believed), faults.

    What the samples of a value that turns out to be frozen have done to the motor speed is taken back. A speed from
    counts moves the angle counted on, so that the angle is measured from the newest count.
    """
    torque, faults = torque_believed(p, s, TORQUE, inputs, faults)
    speed = inputs[1]
    missing = faults & 2 != 0
    if s[STARTED] == 0.0:
        restart(p, s, 0.0 if missing else speed)
    innovation = speed - (s[ANGLE] / p[DT] if p[AVERAGED] else s[1])
    expected = p[EXPECTED] + p[GROWTH] * s[UNBELIEVED]
    expected += p[MISSING_TORQUE] * p[DT] * s[BLIND] / p[GATE]
    expected += p[COARSER] * max(deviation_of_steps(s, SENSOR) - p[NOISE], 0.0)
    verdict = sensor_believed(p, s, SENSOR, 0, speed, missing, s[MOVED], innovation, expected * expected)
    if verdict == START_AGAIN:
        restart(p, s, speed)
    if verdict == FROZEN:
        s[1] -= s[GIVEN]
        s[GIVEN] = 0.0
    if verdict != USE:
        s[BLIND] = min(s[BLIND] + float(faults & 1), p[HOLD])
        s[UNBELIEVED] = min(s[UNBELIEVED] + 1.0, p[HOLD])
        s[ANGLE] = 0.0
        return torque, 0.0, faults | 2
    fresh, s[UNBELIEVED] = s[UNBELIEVED] > 0.0, 0.0
    s[ANGLE] -= speed * p[DT]
    s[BLIND] = max(s[BLIND] - FADE, 0.0)
    if fresh and s[BLIND] > SHORT * p[HOLD]:
        # What a torque that nobody knew did to the motor is no error of the model's; it tells nothing of the load.
        s[1] += innovation
        s[ANGLE] += innovation * p[DT]
        return torque, 0.0, faults
    if faults & 1:
        # Without a motor torque the model's motor follows the measured speed, and nothing else is corrected.
        s[1] += innovation
        s[ANGLE] += innovation * p[DT]
        return torque, 0.0, faults
    return torque, innovation, faults


@njit(cache=True, inline="always")
def outputs_of(p, s, outputs):
    write_estimates(p, s[0], s[1], s[2], p[HALF], s[FRICTION], outputs)


@njit(cache=True, inline="always")
def correct(p, s, angle, twist, motor, load):
    """The corrections; those of twist and load only where the motor can feel them.

    In the gap the motor speed says nothing about them, and a load that sticks needs none. Not so while nobody knows
    whether the joint is in the gap, after all inputs were missing.
    """
    if s[BLIND] > UNSURE * p[HOLD] or abs(s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])) > p[HALF]:
        s[0] += twist
        if abs(s[FRICTION]) >= p[COULOMB] * min(p[RATIO_PLUS], p[RATIO_MINUS]):
            s[2] += load
    s[1] += motor
    s[GIVEN] = motor if s[SENSOR + 1] == 1.0 else s[GIVEN] + motor
    s[ANGLE] += angle


@njit(cache=True, inline="always")
def predict(p, s, torque):
    """One sample of the model, in pieces; returns whether the estimate was lost and starts again."""
    before, friction = s[1], 0.0
    for _ in range(int(p[PIECES])):
        z = s[0] + p[LEAD_MIDDLE] * (s[1] - s[2])
        gap = clip(z, -p[HALF], p[HALF])
        n0, n1, n2, n3, turn, _, friction = advance(p, s[0], s[1], s[2], s[3], 0.0, p[COULOMB], gap, torque)
        s[0], s[1], s[2], s[3] = n0, n1, n2, n3
        s[ANGLE] += turn
    s[MOVED], s[FRICTION] = s[1] - before, friction
    if not (abs(s[0]) < LOST and abs(s[1]) < LOST and abs(s[2]) < LOST and abs(s[3]) < LOST):
        restart(p, s, 0.0)
        s[STARTED] = 0.0
        return True
    return False

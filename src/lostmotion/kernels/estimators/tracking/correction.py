"""Correction of the estimate by its sensors, one after the other, where their samples are used."""

from __future__ import annotations

import math

from ...jit import njit
from ..contact import cancel_contact
from ..kalman import correct, inflate
from ..layout import SPEED_MOTOR, TORQUE_LOAD
from ..sensor_check import REFUSED_RATE, check_sample
from ..sensors import OF_SPEED_LOAD, OF_SPEED_MOTOR, count_from_here
from ..verdicts import FROZEN, JUMP, START_AGAIN, USE
from .measurement import innovation_of, moved_by_model
from .outputs import write
from .start import begin, bound, restart, start_again_if_lost


@njit(cache=True)
def check(p, s, i, value, missing, nu, S):
    """Verdict on the sample of sensor i."""
    moved = moved_by_model(p, s, int(p.kind[i]))
    return check_sample(p, i, s.sensors[i], value, missing, moved, nu, S)


@njit(cache=True)
def correct_all(p, s, inputs, given, H, PHt):
    """Every sensor in turn: samples that are used correct the estimate; returns the faults."""
    x, P = s.estimate.x, s.estimate.P
    faults = given
    for i in range(int(p.sensors)):
        kind, value = int(p.kind[i]), inputs[1 + i]
        nu, S, R = innovation_of(p, s.sensors[i], x, P, i, value, H, PHt)
        verdict = check(p, s, i, value, given & (2 << i) != 0, nu, S)
        if verdict == USE:
            correct(x, P, PHt, nu, S)
            bound(p, x)
        else:
            faults |= 2 << i
        if kind == OF_SPEED_MOTOR and verdict in (USE, JUMP):
            cancel_contact(p, x, P, s.contact, nu, S)
        if verdict in (FROZEN, JUMP):
            inflate(P, TORQUE_LOAD, math.exp(REFUSED_RATE * p.dt), p.largest_deviation)
        if verdict == START_AGAIN:
            restart(p, s, value if kind <= OF_SPEED_LOAD else x[SPEED_MOTOR], TORQUE_LOAD)
        if kind == OF_SPEED_MOTOR and p.counted:
            count_from_here(x, P, value * p.scale[i], R, verdict == USE)
    return faults


@njit(cache=True)
def measurement_update(p, s, inputs, faults, outputs, H, PHt):
    """The estimate of this sample, by all its sensors, and the outputs; returns the torque to use and the faults."""
    torque, faults = begin(p, s, inputs, faults)
    faults = correct_all(p, s, inputs, faults, H, PHt)
    start_again_if_lost(p, s)
    write(p, s, H, PHt, outputs)
    return torque, faults

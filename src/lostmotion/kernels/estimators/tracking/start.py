"""Start of a filter that tracks parameters, the bounds of its parameters, and what brings it back once it is lost."""

from __future__ import annotations

from ...jit import njit
from ..contact import no_contact
from ..layout import (
    BACKLASH,
    COULOMB,
    INVERSE_INERTIA_LOAD,
    INVERSE_INERTIA_MOTOR,
    SPEED_LOAD,
    SPEED_MOTOR,
    STIFFNESS,
    TORQUE_ACTUATOR,
    TRACKED,
    TRACKING,
    size,
)
from ..missing_inputs import add_missing_torque, blind_samples, torque_to_use
from ..records import reads
from ..sensor_check import LOST
from ..sensors import OF_SPEED_MOTOR
from ..two_mass_model import clip

memory_of = reads(TRACKING)
SIZE = size(TRACKING)

#: Option: stiffness and inverse inertias stay within these factors of what was given, so that no input can make the
#: model meaningless; the backlash below so many times its start value.
LEAST_FACTOR, LARGEST_FACTOR = 0.5, 2.0
#: Option, likewise.
LARGEST_BACKLASH = 20.0


@njit(cache=True)
def restart(p, s, speed, states):
    """Both inertias at ``speed``; of the rest, the first ``states`` as known beforehand."""
    x, P = s.estimate.x, s.estimate.P
    for i in range(states):
        x[i] = p.x0[i]
        for j in range(TRACKED):
            P[i, j] = P[j, i] = 0.0
        P[i, i] = p.P0[i]
    x[SPEED_MOTOR] = x[SPEED_LOAD] = speed
    x[TORQUE_ACTUATOR] = s.torque
    keep_before(s)
    s.friction = 0.0
    no_contact(s.contact)
    s.started = 1.0


@njit(cache=True, inline="always")
def keep_before(s):
    """The moving states before a prediction: what the model alone moves is the change from them."""
    for i in range(4):
        s.before[i] = s.estimate.x[i]


@njit(cache=True)
def before_first_sample(p, s):
    """The memory that waits for a sample."""
    restart(p, s, 0.0, TRACKED)
    s.started = 0.0


@njit(cache=True)
def begin(p, s, inputs, faults):
    """The torque to use and the faults; a first sample starts the filter."""
    torque, faults = torque_to_use(p, s, inputs[0], faults)
    s.blind = blind_samples(p, s.blind, faults)
    add_missing_torque(p, s.estimate.P, faults & 1 != 0, s.blind)
    if s.started == 0.0:
        known = int(p.kind[0]) == OF_SPEED_MOTOR and faults & 2 == 0
        restart(p, s, inputs[1] if known else 0.0, TRACKED)
    return torque, faults


@njit(cache=True)
def bound(p, x):
    """Parameters stay where the model has a meaning."""
    x[BACKLASH] = clip(x[BACKLASH], 0.0, LARGEST_BACKLASH * p.x0[BACKLASH])
    x[COULOMB] = clip(x[COULOMB], 0.0, p.coulomb_bound)
    x[STIFFNESS] = clip(x[STIFFNESS], LEAST_FACTOR, LARGEST_FACTOR)
    x[INVERSE_INERTIA_MOTOR] = clip(x[INVERSE_INERTIA_MOTOR], LEAST_FACTOR, LARGEST_FACTOR)
    x[INVERSE_INERTIA_LOAD] = clip(x[INVERSE_INERTIA_LOAD], LEAST_FACTOR, LARGEST_FACTOR)


@njit(cache=True)
def _lost(x, P):
    for i in range(TRACKED):  # noqa: SIM110 — numba knows no any()
        if not abs(x[i]) < LOST or not P[i, i] < LOST * LOST:
            return True
    return False


@njit(cache=True)
def start_again_if_lost(p, s):
    """Start again if the estimate is no number of this drivetrain."""
    if _lost(s.estimate.x, s.estimate.P):
        restart(p, s, 0.0, TRACKED)
        s.started = s.torque_moments.mean = s.torque_moments.variance = 0.0

"""The two-mass model with gap and friction, over a substep of a sample; shaft torque and outputs of every estimator.

It is the model of ``kernels.innovations.two_mass``; its states are the first five of ``layout``::

    x⁺ = Φ x + Γ u,    u = torque_motor, gap, friction_motor, friction_load
    gap = clip(z, ±half),    z = twist + lead·(speed_motor − speed_load)

A speed from count differences, times the sample time, measures the state ``ANGLE_COUNTED``, in which the error of one
count is white: in the speed itself it comes twice, with opposite signs, and nearly cancels.

A long sample is split into equal substeps, so that the gap term is held for a short time only.
"""

from __future__ import annotations

from ..jit import njit
from .layout import (
    ANGLE_COUNTED,
    FRICTION_LOAD,
    FRICTION_MOTOR,
    GAP,
    SPEED_LOAD,
    SPEED_MOTOR,
    TORQUE,
    TORQUE_ACTUATOR,
    TWIST,
)


@njit(cache=True, inline="always")
def clip(value, low, high):
    return min(max(value, low), high)


@njit(cache=True, inline="always")
def gap_argument(x, lead):
    """z: the shaft is in contact where it lies beyond an edge of the gap."""
    return x[TWIST] + lead * (x[SPEED_MOTOR] - x[SPEED_LOAD])


@njit(cache=True, inline="always")
def _row(A, i, x, torque, gap, torque_load):
    """Row i of Φ x + Γ u without friction; a load torque acts where the load's friction does."""
    return (
        A[i, 0] * x[0]
        + A[i, 1] * x[1]
        + A[i, 2] * x[2]
        + A[i, 3] * x[3]
        + A[i, TORQUE] * torque
        + A[i, GAP] * gap
        - A[i, FRICTION_LOAD] * torque_load
    )


@njit(cache=True, inline="always")
def shaft_slope(p):
    """Nm per rad/s of twist rate that the shaft torque gains until the middle of a substep, damping included."""
    return p.damping + p.stiffness * (p.lead_middle - p.lead)


@njit(cache=True, inline="always")
def advance(p, x, torque_load, coulomb, gap, torque, stiffness=1.0, inverse_motor=1.0, inverse_load=1.0):
    """The first four states of x after a substep, with the gap term given; the motor's turn; the frictions.

    Each friction takes what brings its inertia to rest at the end of the substep, within its Coulomb level.

    ``stiffness`` multiplies the shaft's torque (its damping too), each ``inverse_…`` an inverse inertia. What they
    change is a torque held over the substep: on both ends the shaft torque of the middle of the substep that the model
    lacks, on an inertia what its change of speed lacks.
    """
    A, rate = p.transition, x[SPEED_MOTOR] - x[SPEED_LOAD]
    n0 = _row(A, TWIST, x, torque, gap, torque_load)
    n1 = _row(A, SPEED_MOTOR, x, torque, gap, torque_load)
    n2 = _row(A, SPEED_LOAD, x, torque, gap, torque_load)
    n3 = A[TORQUE_ACTUATOR, TORQUE_ACTUATOR] * x[TORQUE_ACTUATOR] + A[TORQUE_ACTUATOR, TORQUE] * torque
    turn = _row(A, ANGLE_COUNTED, x, torque, gap, torque_load)
    lacking = (stiffness - 1.0) * (p.stiffness * (x[TWIST] - gap) + shaft_slope(p) * rate)
    both_motor = A[SPEED_MOTOR, FRICTION_MOTOR] - A[SPEED_MOTOR, FRICTION_LOAD]
    both_load = A[SPEED_LOAD, FRICTION_MOTOR] - A[SPEED_LOAD, FRICTION_LOAD]
    change_motor = n1 + both_motor * lacking - x[SPEED_MOTOR]
    change_load = n2 + both_load * lacking - x[SPEED_LOAD]
    at_motor = (1.0 - inverse_motor) * change_motor * p.rest_motor + lacking
    at_load = (1.0 - inverse_load) * change_load * p.rest_load - lacking
    n0 += A[TWIST, FRICTION_MOTOR] * at_motor + A[TWIST, FRICTION_LOAD] * at_load
    n1 += A[SPEED_MOTOR, FRICTION_MOTOR] * at_motor + A[SPEED_MOTOR, FRICTION_LOAD] * at_load
    n2 += A[SPEED_LOAD, FRICTION_MOTOR] * at_motor + A[SPEED_LOAD, FRICTION_LOAD] * at_load
    turn += A[ANGLE_COUNTED, FRICTION_MOTOR] * at_motor + A[ANGLE_COUNTED, FRICTION_LOAD] * at_load
    level = p.coulomb_motor * inverse_motor
    motor = clip(n1 * p.rest_motor, -level, level)
    n2 += A[SPEED_LOAD, FRICTION_MOTOR] * motor
    level = coulomb * inverse_load
    load = clip(n2 * p.rest_load, -p.ratio_minus * level, p.ratio_plus * level)
    n0 += A[TWIST, FRICTION_MOTOR] * motor + A[TWIST, FRICTION_LOAD] * load
    n1 += A[SPEED_MOTOR, FRICTION_MOTOR] * motor + A[SPEED_MOTOR, FRICTION_LOAD] * load
    n2 += A[SPEED_LOAD, FRICTION_LOAD] * load
    turn += A[ANGLE_COUNTED, FRICTION_MOTOR] * motor + A[ANGLE_COUNTED, FRICTION_LOAD] * load
    return n0, n1, n2, n3, turn, motor, load


@njit(cache=True, inline="always")
def shaft_torque(p, x, gap):
    """Shaft torque of the stiffness and damping as given, with gap = clip(twist + lead·rate, ±half)."""
    return p.stiffness * (x[TWIST] - gap) + p.damping * (x[SPEED_MOTOR] - x[SPEED_LOAD])


@njit(cache=True, inline="always")
def elastic_change(now, before, half):
    """Change of the elastic twist: within the gap none."""
    return now - clip(now, -half, half) - before + clip(before, -half, half)


@njit(cache=True, inline="always")
def write_estimates(p, x, half, coulomb_torque, outputs):
    """The six outputs that every observer has."""
    outputs[0] = x[TWIST]
    outputs[1] = x[TWIST] - clip(x[TWIST], -half, half)
    outputs[2] = x[SPEED_MOTOR]
    outputs[3] = x[SPEED_LOAD]
    outputs[4] = shaft_torque(p, x, clip(gap_argument(x, p.lead), -half, half))
    outputs[5] = coulomb_torque + p.viscous * x[SPEED_LOAD]


@njit(cache=True, inline="always")
def eigenmode_variance(share, rate, moments, torque):
    """Variance that eigenmodes beyond the model add to the shaft torque: its own recent variance, the share squared.

    What makes them swing is what the torque itself does. Its mean and variance forget by ``rate`` with each sample.
    """
    away = torque - moments.mean
    moments.mean += rate * away
    moments.variance += rate * (away * away - moments.variance)
    return share * share * moments.variance

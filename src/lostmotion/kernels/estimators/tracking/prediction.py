"""Prediction by the linearised model: a substep of the states, and the matrix F of its derivatives."""

from __future__ import annotations

from ...jit import njit
from ..contact import edge_deviation, mean_gap
from ..kalman import predict_covariance
from ..layout import (
    ANGLE_COUNTED,
    BACKLASH,
    COULOMB,
    FRICTION_LOAD,
    FRICTION_MOTOR,
    GAP,
    INVERSE_INERTIA_LOAD,
    INVERSE_INERTIA_MOTOR,
    MOVING,
    SPEED_LOAD,
    SPEED_MOTOR,
    STIFFNESS,
    TORQUE_ACTUATOR,
    TORQUE_LOAD,
    TRACKED,
    TWIST,
)
from ..two_mass_model import advance, gap_argument, shaft_slope


@njit(cache=True)
def move(p, x, P, torque, F):
    """Equation (5) of ``kalman``: x a substep on, in place, with F = ∂f/∂x; returns the load's Coulomb torque.

    The gap term is its mean over the spread of an estimate with covariance P.
    """
    deviation = edge_deviation(P, p.lead_middle)
    gap, above, below = mean_gap(gap_argument(x, p.lead_middle), 0.5 * max(x[BACKLASH], 0.0), deviation)
    n0, n1, n2, n3, turn, motor, load = advance(
        p, x, x[TORQUE_LOAD], max(x[COULOMB], 0.0), gap, torque,
        x[STIFFNESS], x[INVERSE_INERTIA_MOTOR], x[INVERSE_INERTIA_LOAD],
    )  # fmt: skip
    change = n1 - x[SPEED_MOTOR], n2 - x[SPEED_LOAD]
    jacobian(p, x, gap, 1.0 - above - below, above - below, change, motor, load, F)
    x[TWIST], x[SPEED_MOTOR], x[SPEED_LOAD], x[TORQUE_ACTUATOR] = n0, n1, n2, n3
    x[ANGLE_COUNTED] += turn * p.counted
    return load / x[INVERSE_INERTIA_LOAD]


@njit(cache=True)
def predict(p, s, torque, F, FP):
    """Equations (5) and (6) of ``kalman``: x and P a sample on, in substeps."""
    x, P = s.estimate.x, s.estimate.P
    for _ in range(int(p.substeps)):
        s.friction = move(p, x, P, torque, F)
        predict_covariance(F, P, p.Q, FP)


@njit(cache=True)
def jacobian(p, x, gap, inside, edge, change, motor, load, F):
    """F (MOVING, TRACKED): derivatives of the moving states by all; the other rows are constants.

    Parameters
    ----------
    gap, inside, edge : float
        Gap term; its derivatives by z and by half of the backlash.
    change : (float, float)
        Of both speeds over the substep.
    motor, load : float
        Frictions.
    """
    A, lead = p.transition, p.lead_middle
    for i in range(MOVING):
        by_gap = A[i, GAP]
        F[i, TWIST] = A[i, 0] + by_gap * inside
        F[i, SPEED_MOTOR] = A[i, 1] + by_gap * inside * lead
        F[i, SPEED_LOAD] = A[i, 2] - by_gap * inside * lead
        F[i, TORQUE_ACTUATOR] = A[i, 3]
        F[i, ANGLE_COUNTED] = 0.0
        F[i, TORQUE_LOAD] = -A[i, FRICTION_LOAD]
        F[i, BACKLASH] = 0.5 * by_gap * edge
        F[i, COULOMB] = 0.0
    F[ANGLE_COUNTED, ANGLE_COUNTED] = 1.0
    _by_factors(p, x, gap, inside, edge, change[0], change[1], F)
    inverse_load = x[INVERSE_INERTIA_LOAD]
    if abs(motor) < p.coulomb_motor * x[INVERSE_INERTIA_MOTOR]:
        _at_rest(p, FRICTION_MOTOR, p.rest_motor, F, SPEED_MOTOR)
    plus, minus, level = p.ratio_plus, p.ratio_minus, inverse_load * max(x[COULOMB], 0.0)
    if load >= plus * level:
        for i in range(MOVING):
            F[i, COULOMB] += A[i, FRICTION_LOAD] * plus * inverse_load
    elif load <= -minus * level:
        for i in range(MOVING):
            F[i, COULOMB] -= A[i, FRICTION_LOAD] * minus * inverse_load
    else:
        _at_rest(p, FRICTION_LOAD, p.rest_load, F, SPEED_LOAD)


@njit(cache=True)
def _by_factors(p, x, gap, inside, edge, motor_change, load_change, F):
    """The columns of the factors of stiffness and inverse inertias, and what these factors change in the others."""
    A, k, slope, lacking = p.transition, p.stiffness, shaft_slope(p), x[STIFFNESS] - 1.0
    torque = k * (x[TWIST] - gap) + slope * (x[SPEED_MOTOR] - x[SPEED_LOAD])
    by_rate = slope - k * inside * p.lead_middle
    at_motor, at_load = A[SPEED_MOTOR, FRICTION_MOTOR], A[SPEED_LOAD, FRICTION_LOAD]
    for i in range(MOVING):
        both = A[i, FRICTION_MOTOR] - A[i, FRICTION_LOAD]
        F[i, TWIST] += lacking * both * k * (1.0 - inside)
        F[i, SPEED_MOTOR] += lacking * both * by_rate
        F[i, SPEED_LOAD] -= lacking * both * by_rate
        F[i, BACKLASH] -= lacking * both * 0.5 * k * edge
        F[i, STIFFNESS] = both * torque
        F[i, INVERSE_INERTIA_MOTOR] = (
            A[i, FRICTION_MOTOR] / at_motor * motor_change / x[INVERSE_INERTIA_MOTOR]
        )
        F[i, INVERSE_INERTIA_LOAD] = A[i, FRICTION_LOAD] / at_load * load_change / x[INVERSE_INERTIA_LOAD]
    for j in range(INVERSE_INERTIA_MOTOR):
        own_motor, own_load = 1.0 if j == SPEED_MOTOR else 0.0, 1.0 if j == SPEED_LOAD else 0.0
        motor = (x[INVERSE_INERTIA_MOTOR] - 1.0) * (F[SPEED_MOTOR, j] - own_motor) / at_motor
        load = (x[INVERSE_INERTIA_LOAD] - 1.0) * (F[SPEED_LOAD, j] - own_load) / at_load
        for i in range(MOVING):
            F[i, j] += A[i, FRICTION_MOTOR] * motor + A[i, FRICTION_LOAD] * load


@njit(cache=True)
def _at_rest(p, column, torque, F, speed):
    """The friction that brings ``speed`` to rest follows all that moves it."""
    A = p.transition
    for j in range(TRACKED):
        if j not in (ANGLE_COUNTED, COULOMB):
            slope = F[speed, j] * torque
            for i in range(MOVING):
                F[i, j] += A[i, column] * slope

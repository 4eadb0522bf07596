"""Interacting models: one model a substep on, linear in its region but for the friction."""

from __future__ import annotations

from ...jit import njit
from ..layout import (
    ANGLE_COUNTED,
    FRICTION_LOAD,
    FRICTION_MOTOR,
    GAP,
    MODEL_COULOMB,
    MODEL_STATES,
    MOVING,
    SPEED_LOAD,
    SPEED_MOTOR,
    TORQUE_ACTUATOR,
    TORQUE_LOAD,
    TWIST,
)
from ..two_mass_model import advance, gap_argument
from .state import IN_GAP, edge


@njit(cache=True)
def predict(own, estimate, m, start, torque, F, FP):
    """Model m a substep on, from the mixed ``start``; returns the load's Coulomb torque.

    Its gap term is that of its own side: +half, the argument itself, −half.
    """
    p, x, P = own.common, start.x, estimate.P
    gap = gap_argument(x, p.lead_middle) if m == IN_GAP else edge(own, m)
    n0, n1, n2, n3, turn, motor, load = advance(p, x, x[TORQUE_LOAD], x[MODEL_COULOMB], gap, torque)
    _jacobian(p, 1.0 if m == IN_GAP else 0.0, motor, load, x[MODEL_COULOMB], F)
    _predict_covariance(F, start.P, p.Q, P, FP)
    P[TWIST, TWIST] += own.gap_Q if m == IN_GAP else p.Q[TWIST]
    to = estimate.x
    to[TWIST], to[SPEED_MOTOR], to[SPEED_LOAD], to[TORQUE_ACTUATOR] = n0, n1, n2, n3
    to[ANGLE_COUNTED], to[TORQUE_LOAD] = x[ANGLE_COUNTED] + turn * p.counted, x[TORQUE_LOAD]
    to[MODEL_COULOMB] = x[MODEL_COULOMB]
    return load


@njit(cache=True)
def _jacobian(p, inside, motor, load, coulomb, F):
    """F (MOVING, MODEL_STATES): derivatives of the moving states.

    Not by the counted angle, on which only itself depends.
    """
    A, lead = p.transition, p.lead_middle
    for i in range(MOVING):
        gap = A[i, GAP] * inside
        F[i, TWIST] = A[i, 0] + gap
        F[i, SPEED_MOTOR] = A[i, 1] + gap * lead
        F[i, SPEED_LOAD] = A[i, 2] - gap * lead
        F[i, TORQUE_ACTUATOR] = A[i, 3]
        F[i, TORQUE_LOAD] = -A[i, FRICTION_LOAD]
        F[i, MODEL_COULOMB] = 0.0
    if abs(motor) < p.coulomb_motor:
        _at_rest(A, FRICTION_MOTOR, p.rest_motor, F, SPEED_MOTOR)
    slips = 0.0
    if load >= p.ratio_plus * coulomb:
        slips = p.ratio_plus
    elif load <= -p.ratio_minus * coulomb:
        slips = -p.ratio_minus
    else:
        _at_rest(A, FRICTION_LOAD, p.rest_load, F, SPEED_LOAD)
    for i in range(MOVING):
        F[i, MODEL_COULOMB] += A[i, FRICTION_LOAD] * slips


@njit(cache=True)
def _at_rest(A, column, torque, F, speed):
    """The friction that brings ``speed`` to rest follows all that moves it."""
    for j in (TWIST, SPEED_MOTOR, SPEED_LOAD, TORQUE_ACTUATOR, TORQUE_LOAD):
        slope = F[speed, j] * torque
        for i in range(MOVING):
            F[i, j] += A[i, column] * slope


@njit(cache=True)
def _predict_covariance(F, start, Q, P, FP):
    """P = F start Fᵀ + Q, without the twist's Q; all derivatives by the counted angle are zero but its own."""
    for i in range(MOVING):
        for j in range(MODEL_STATES):
            FP[i, j] = (
                F[i, 0] * start[0, j]
                + F[i, 1] * start[1, j]
                + F[i, 2] * start[2, j]
                + F[i, 3] * start[3, j]
                + F[i, 5] * start[5, j]
                + F[i, 6] * start[6, j]
            )
    for j in range(MODEL_STATES):
        FP[ANGLE_COUNTED, j] += start[ANGLE_COUNTED, j]
    for i in range(MOVING):
        for j in range(i, MOVING):
            value = (
                FP[i, 0] * F[j, 0]
                + FP[i, 1] * F[j, 1]
                + FP[i, 2] * F[j, 2]
                + FP[i, 3] * F[j, 3]
                + FP[i, 5] * F[j, 5]
                + FP[i, 6] * F[j, 6]
            )
            if j == ANGLE_COUNTED:
                value += FP[i, ANGLE_COUNTED]
            P[i, j] = P[j, i] = value
        for j in range(MOVING, MODEL_STATES):
            P[i, j] = P[j, i] = FP[i, j]
    for i in range(MOVING, MODEL_STATES):
        for j in range(MOVING, MODEL_STATES):
            P[i, j] = start[i, j]
    for i in range(1, MODEL_STATES):
        P[i, i] += Q[i]

"""Hybrid predictive control: one step. The instant of the next contact is enumerated, see ``controllers``."""

from __future__ import annotations

import numpy as np

from ..estimators.runner import INIT, STEP
from ..jit import njit
from .layout import (
    ACTUATOR,
    BAND,
    BOUNDS,
    CANDIDATES,
    COULOMB_MINUS,
    COULOMB_PLUS,
    DECAY,
    HALF_GAP,
    LEAST,
    LIMIT,
    MOVES,
    PLANS,
    PROGRAM,
    PROGRAM_SCRATCH,
    PROGRAMS,
    RESULT,
    ROW_MOVES,
    SCRATCH,
    SIGNALS,
    START,
    STATE,
    VISCOUS,
    VISCOUS_MOTOR,
    WINNER,
)
from .quadratic_program import form, solve

#: No candidate (numerics: beyond every cost).
NONE = 1e300
#: Most steps for one candidate, and for all of a sample (calibrated on the virtual rigs 1 to 3).
STEPS, ALL_STEPS = 12, 40


@njit("float64(float64[::1], float64[::1], float64, float64[::1])", cache=True)
def start_of(p, inputs, side, state):
    """Fills the signals of a plan that lands on this side (±1); gives the torque that holds, seen from there."""
    reference, speed_load = inputs[0], inputs[4]
    direction = reference / p[BAND]
    direction = 1.0 if direction > 1.0 else (-1.0 if direction < -1.0 else direction)
    friction = (p[COULOMB_PLUS] if direction > 0.0 else p[COULOMB_MINUS]) * direction
    # The observer's friction has its viscous part at the present speed; the steady state has it at the set-point.
    shaft = inputs[5] + p[VISCOUS] * (reference - speed_load) - inputs[7]
    hold = side * (shaft + p[VISCOUS_MOTOR] * reference + friction)
    state[START] = side * inputs[1] - p[HALF_GAP]
    state[START + 1] = side * (inputs[3] - reference)
    state[START + 2] = side * (speed_load - reference)
    state[START + 3] = side * state[ACTUATOR] - hold
    state[START + 4] = side * inputs[6] - hold
    state[START + 5] = side * shaft
    state[START + 6] = hold
    return hold


@njit("int64(float64[::1], float64[::1], float64[::1])", cache=True)
def bound_costs(p, inputs, state):
    """What each candidate costs at least; beyond every cost where it is out of the question."""
    for number in range(2 * CANDIDATES):
        side = 1.0 if number < CANDIDATES else -1.0
        place = number if number < CANDIDATES else number - CANDIDATES
        if place == 0:
            start_of(p, inputs, side, state)
        closed = side * inputs[2] > 0.0
        least = NONE
        if closed == (place == 0):
            program = PROGRAMS + place * PROGRAM
            least = form(p[program + LEAST : program + ROW_MOVES], state[START:BOUNDS])
        state[BOUNDS + number] = least
    return 0


@njit("int64(float64[::1])", cache=True)
def most_promising(state):
    """The candidate with the smallest bound."""
    found = 0
    for number in range(1, 2 * CANDIDATES):
        if state[BOUNDS + number] < state[BOUNDS + found]:
            found = number
    return found


@njit(INIT, cache=True)
def init(parameters):
    return np.zeros(STATE)


@njit(STEP, cache=True)
def step(parameters, state, inputs, faults, outputs):
    limit = parameters[LIMIT]
    bound_costs(parameters, inputs, state)
    number = int(state[WINNER])
    if number < 0 or number >= 2 * CANDIDATES or state[BOUNDS + number] >= NONE:
        number = most_promising(state)
    best, torque, winner = NONE, 0.0, number
    left = ALL_STEPS
    # The winner of the sample before comes first: its plan is there whatever the others take.
    while left > 0 and state[BOUNDS + number] < best:
        side = 1.0 if number < CANDIDATES else -1.0
        place = number if number < CANDIDATES else number - CANDIDATES
        program = PROGRAMS + place * PROGRAM
        plan = PLANS + number * MOVES
        hold = start_of(parameters, inputs, side, state)
        left -= solve(
            parameters[program : program + PROGRAM], state[START : START + SIGNALS], hold, limit,
            state[plan : plan + MOVES], state[SCRATCH : SCRATCH + PROGRAM_SCRATCH],
            STEPS if left > STEPS else left,
        )  # fmt: skip
        if state[SCRATCH + RESULT] < best:
            best = state[SCRATCH + RESULT]
            winner = number
            torque = side * state[plan]
        state[BOUNDS + number] = NONE
        number = most_promising(state)
    state[WINNER] = float(winner)
    outputs[0] = torque
    decay = parameters[DECAY]
    state[ACTUATOR] = decay * state[ACTUATOR] + (1.0 - decay) * inputs[6]
    return faults

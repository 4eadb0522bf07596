"""Every number of hybrid predictive control by its place: parameters, state, scratch.

Kernels read them by these constants, so that the exported C code can do the same.
"""

from __future__ import annotations

#: Moves of a plan; candidates of each side: the shaft closed, and so many instants of contact (layout).
MOVES, INSTANTS = 8, 20
CANDIDATES = 1 + INSTANTS
#: Signals that a plan starts from, see ``hybrid``: elastic twist, both speeds from the set-point, torque of the current
#: loop and last torque from the one that holds, shaft torque and motor torque that hold (layout).
SIGNALS = 7
#: Soft rows on a plan: impact speed before, at and after the contact, twist at so many moments, torque of each move
#: (layout).
IMPACT_ROWS, TWIST_ROWS = 3, 12
TORQUE_ROWS = IMPACT_ROWS + TWIST_ROWS
ROWS = TORQUE_ROWS + MOVES

#: A candidate's program (layout): hessian, gradient by signals, cost by signals of the plan 0, least cost without any
#: limit, and the soft rows: by moves, by signals, low, high, and the weight beyond either.
HESSIAN, GRADIENT = 0, MOVES * MOVES
COST = GRADIENT + MOVES * SIGNALS
LEAST = COST + SIGNALS * SIGNALS
ROW_MOVES = LEAST + SIGNALS * SIGNALS
ROW_SIGNALS = ROW_MOVES + ROWS * MOVES
ROW_LOW = ROW_SIGNALS + ROWS * SIGNALS
ROW_HIGH = ROW_LOW + ROWS
ROW_LOW_WEIGHT = ROW_HIGH + ROWS
ROW_HIGH_WEIGHT = ROW_LOW_WEIGHT + ROWS
PROGRAM = ROW_HIGH_WEIGHT + ROWS

#: Parameters (layout): of the law, then one program per candidate.
LIMIT, DECAY, HALF_GAP, VISCOUS, VISCOUS_MOTOR, COULOMB_PLUS, COULOMB_MINUS, BAND, PROGRAMS = range(9)
PARAMETERS = PROGRAMS + CANDIDATES * PROGRAM

#: State (layout): torque of the current loop (Nm), the candidate that won, all candidates' plans for both sides (Nm).
ACTUATOR, WINNER, PLANS = 0, 1, 2
# Scratch, part of the state so that a step needs no memory of its own; written before it is read.
START = PLANS + 2 * CANDIDATES * MOVES
BOUNDS = START + SIGNALS
SCRATCH = BOUNDS + 2 * CANDIDATES

#: Scratch of one program: places (layout).
RESULT, LINEAR, POINT, SLOPE, DIRECTION, FIXED = 0, 1, 1 + MOVES, 1 + 2 * MOVES, 1 + 3 * MOVES, 1 + 4 * MOVES
VALUE = 1 + 5 * MOVES
CHANGE = VALUE + ROWS
FACTOR = CHANGE + ROWS
PROGRAM_SCRATCH = FACTOR + MOVES * MOVES
STATE = SCRATCH + PROGRAM_SCRATCH

"""Quadratic programs of a plan across the gap: one for each instant at which the gap may close."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...kernels.predictive.layout import IMPACT_ROWS, MOVES, ROWS, SIGNALS, TORQUE_ROWS, TWIST_ROWS
from ...systems import zero_order_hold
from .plan_cost import Phase, Plan, plan_cost

Array = NDArray[np.float64]

# What a plan starts from, seen from the side on which it lands; all but the twist and the last two are differences from
# what holds the set-point.
TWIST, SPEED_MOTOR, SPEED_LOAD, TORQUE_ACTUATOR, TORQUE_LAST, SHAFT, HOLD = range(SIGNALS)
#: Bound of a soft row that has none on that side: beyond every signal, and finite (numerics).
FREE = 1e30
#: Motor speed against load speed, over the signals.
CLOSING = np.eye(SIGNALS)[SPEED_MOTOR] - np.eye(SIGNALS)[SPEED_LOAD]


@dataclass(frozen=True, eq=False)
class CrossingProblem:
    """What all plans share.

    Parameters
    ----------
    gap, closed : (A, B), arrays (7, 7) and (7,)
        The drivetrain over the signals with the gap open and closed, from sample to sample.
    error, oscillation : (7,) arrays
        Rows over the signals, each in units of its wish.
    torque_weight, change_weight : float, 1/Nm²
        Of each sample's torque, and of the change from move to move.
    last : (7, 7) array
        Cost of all that follows the horizon.
    contact_speed : float, rad/s
    early, late : int
        Samples before and after the contact in which that speed must not be exceeded either.
    twist_limit, torque_soft, braking_torque : float, rad, Nm, Nm
        Soft limits: elastic twist; torque of each move; torque against the motion in the gap.
    contact_unit, twist_unit, speed_unit, torque_unit : float
        Distance from the edge at the instant of contact, and excess over a soft limit, that cost as much as the largest
        error in one sample.
    """

    gap: tuple[Array, Array]
    closed: tuple[Array, Array]
    error: Array
    oscillation: Array
    torque_weight: float
    change_weight: float
    last: Array
    contact_speed: float
    early: int
    late: int
    twist_limit: float
    torque_soft: float
    braking_torque: float
    contact_unit: float
    twist_unit: float
    speed_unit: float
    torque_unit: float


@dataclass(frozen=True, eq=False)
class Program:
    """min ½ Uᵀ hessian U + (gradient ξ)ᵀ U + ½ ξᵀ cost ξ + ½ Σ weight·dist(row, [low, high])²

    with row = row_moves U + row_signals ξ, over the moves U (m,), as differences from the torque that holds; ξ (7,) are
    the signals at the start.
    """

    hessian: Array
    gradient: Array
    cost: Array
    row_moves: Array
    row_signals: Array
    low: Array
    high: Array
    low_weight: Array
    high_weight: Array

    @property
    def least(self) -> Array:
        """½ ξᵀ least ξ is the cost without any limit: no plan costs less."""
        return np.asarray(self.cost - self.gradient.T @ np.linalg.solve(self.hessian, self.gradient))

    def numbers(self) -> Array:
        """As ``kernels.predictive.layout`` has them."""
        parts = (
            self.hessian, self.gradient, self.cost, self.least, self.row_moves, self.row_signals, self.low, self.high,
            self.low_weight, self.high_weight,
        )  # fmt: skip
        return np.concatenate([part.ravel() for part in parts])


def shaft_models(drivetrain: Drivetrain, dt: float) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """A (7, 7) and B (7,) of the signals with the gap open, and closed; one sample of computing delay."""
    return _shaft_model(drivetrain, dt, 0.0), _shaft_model(drivetrain, dt, 1.0)


def _shaft_model(drivetrain: Drivetrain, dt: float, closed: float) -> tuple[Array, Array]:
    motor, load, lag = drivetrain.inertia_motor, drivetrain.inertia_load, drivetrain.lag
    one = np.eye(SIGNALS)
    shaft = closed * (drivetrain.stiffness * one[TWIST] + drivetrain.damping * CLOSING)
    a, b = np.zeros((SIGNALS, SIGNALS)), np.zeros((SIGNALS, 1))
    a[TWIST] = CLOSING
    a[SPEED_MOTOR] = (one[SHAFT] - shaft - drivetrain.viscous_motor * one[SPEED_MOTOR]) / motor
    a[SPEED_LOAD] = (shaft - one[SHAFT] - drivetrain.viscous * one[SPEED_LOAD]) / load
    if lag > 0.0:
        a[SPEED_MOTOR, TORQUE_ACTUATOR] = 1.0 / motor
        a[TORQUE_ACTUATOR, TORQUE_ACTUATOR], b[TORQUE_ACTUATOR] = -1.0 / lag, 1.0 / lag
    else:
        b[SPEED_MOTOR] = 1.0 / motor
    phi, acting = zero_order_hold(a, b, dt)
    # The torque given now acts one sample later.
    phi[:, TORQUE_LAST] = acting[:, 0]
    phi[TORQUE_LAST] = 0.0
    return phi, one[TORQUE_LAST]


def cost_to_go(model: tuple[Array, Array], rows: Array, weight: float, drivetrain: Drivetrain) -> Array:
    """Cost (7, 7) of all that follows with the gap closed and the quadratic law, without limits."""
    from scipy.linalg import solve_discrete_are

    moving = [
        TWIST,
        SPEED_MOTOR,
        SPEED_LOAD,
        *([TORQUE_ACTUATOR] if drivetrain.lag > 0.0 else []),
        TORQUE_LAST,
    ]
    a, b = model[0][np.ix_(moving, moving)], model[1][moving]
    cost = solve_discrete_are(a, b[:, None], rows[:, moving].T @ rows[:, moving], np.array([[weight]]))
    # At rest the twist is that of the shaft torque that holds.
    to = np.eye(SIGNALS)[moving]
    to[0, SHAFT] = -1.0 / drivetrain.stiffness
    return np.asarray(to.T @ cost @ to)


def crossing_program(problem: CrossingProblem, in_gap: Sequence[int], after: Sequence[int]) -> Program:
    """The program of ``MOVES`` moves: those in the gap, and those after it has closed, of so many samples each."""
    phases = [
        Phase(*problem.gap, problem.error[None], tuple(in_gap)),
        Phase(*problem.closed, np.array([problem.error, problem.oscillation]), tuple(after)),
    ]
    plan = plan_cost([phase for phase in phases if phase.lengths], problem.torque_weight, problem.last)
    # Terms |moves·U + signals·ξ|²: changes of the torque, and the twist at the contact from the gap's edge.
    change = np.eye(MOVES) - np.eye(MOVES, k=-1), np.zeros((MOVES, SIGNALS))
    change[1][0, TORQUE_LAST] = -1.0
    terms = [(problem.change_weight**0.5 * change[0], problem.change_weight**0.5 * change[1])]
    if in_gap:
        contact = sum(in_gap)
        terms.append(
            (plan.forced[contact, :1] / problem.contact_unit, plan.free[contact, :1] / problem.contact_unit)
        )
    return Program(
        plan.hessian + sum(m.T @ m for m, _ in terms),
        plan.state_gradient + sum(m.T @ s for m, s in terms),
        plan.state_cost + sum(s.T @ s for _, s in terms),
        *_soft_rows(problem, plan, in_gap),
    )


def _soft_rows(
    problem: CrossingProblem, plan: Plan, in_gap: Sequence[int]
) -> tuple[Array, Array, Array, Array, Array, Array]:
    """Rows over moves and signals, low, high, weights beyond both."""
    moves, signals = np.zeros((ROWS, MOVES)), np.zeros((ROWS, SIGNALS))
    low, high = np.full(ROWS, -FREE), np.full(ROWS, FREE)
    low_weight, high_weight = np.zeros(ROWS), np.zeros(ROWS)
    contact, gap_moves = sum(in_gap), len(in_gap)
    if in_gap:
        when = (max(contact - problem.early, 0), contact, contact + problem.late)
        for row, state in enumerate(_coasting(problem, plan.lengths, when)):
            signals[row], moves[row] = (CLOSING @ part for part in state)
        high[:IMPACT_ROWS], high_weight[:IMPACT_ROWS] = problem.contact_speed, problem.speed_unit**-2
    # In the gap after each of its moves but the last, which has a term of its own; after the contact a shaft does not
    # pull, nor shall it be wound further than wished.
    inside = np.cumsum(in_gap, dtype=int)[:-1]
    joined = np.linspace(contact, len(plan.free) - 1, TWIST_ROWS - inside.size + 1).round().astype(int)[1:]
    twists, gap = slice(IMPACT_ROWS, TORQUE_ROWS), slice(IMPACT_ROWS, IMPACT_ROWS + inside.size)
    after, samples = slice(gap.stop, TORQUE_ROWS), np.concatenate([inside, joined])
    signals[twists], moves[twists] = plan.free[samples, TWIST], plan.forced[samples, TWIST]
    high[gap], high_weight[gap] = 0.0, problem.contact_unit**-2
    low[after], low_weight[after] = 0.0, problem.contact_unit**-2
    high[after], high_weight[after] = problem.twist_limit, problem.twist_unit**-2
    torques = slice(TORQUE_ROWS, ROWS)
    moves[torques], signals[torques, HOLD] = np.eye(MOVES), 1.0
    low[torques], high[torques] = -problem.torque_soft, problem.torque_soft
    low[torques][:gap_moves] = -min(problem.torque_soft, problem.braking_torque)
    low_weight[torques] = high_weight[torques] = problem.torque_unit**-2
    return moves, signals, low, high, low_weight, high_weight


def _coasting(
    problem: CrossingProblem, lengths: Sequence[int], when: Sequence[int]
) -> list[tuple[Array, Array]]:
    """The signals after so many samples as (by signals, by moves), as if the gap stayed open."""
    move_of = [move for move, length in enumerate(lengths) for _ in range(length)]
    free, forced = np.eye(SIGNALS), np.zeros((SIGNALS, MOVES))
    found = {0: (free, forced)}
    for sample in range(max(when)):
        free, forced = problem.gap[0] @ free, problem.gap[0] @ forced
        forced[:, move_of[min(sample, len(move_of) - 1)]] += problem.gap[1]
        found[sample + 1] = (free, forced)
    return [found[sample] for sample in when]

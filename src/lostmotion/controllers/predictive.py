"""Linear model predictive speed control: the torque limit is part of the plan, a fixed number of passes finds it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..curves import saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DesignModel, DiscreteSystem, design_model
from .feedback.feedback_law import wished_rows
from .feedback.limited_torque import actuator_state
from .feedback.reference_direction import reference_direction
from .planning.plan_cost import Phase, Plan, move_lengths, plan_cost

Array = NDArray[np.float64]

#: Length of the horizon in periods of the shaft's eigenmode, and moves in it, each longer than the one before (option).
HORIZON, MOVES = 1.5, 8
#: Passes over all moves (calibrated on the virtual rigs 1 to 3: more change nothing).
PASSES = 8


def closed_plan(model: DesignModel, rows: Array, torque_weight: float, lengths: Sequence[int]) -> Plan:
    """Cost of Σ |rows·x|² + torque_weight·u² over the moves, and for ever after them with the quadratic law."""
    from scipy.linalg import solve_discrete_are

    last = solve_discrete_are(model.A, model.B[:, None], rows.T @ rows, np.array([[torque_weight]]))
    return plan_cost([Phase(model.A, model.B, rows, tuple(lengths))], torque_weight, last)


@checks_arguments
def predictive(
    drivetrain: Drivetrain,
    *,
    dt: float,
    largest_error: float,
    largest_torque: float,
    torque_limit: float,
    largest_oscillation: float | None = None,
    largest_twist: float = math.inf,
    moves: int = MOVES,
    passes: int = PASSES,
) -> DiscreteSystem:
    """Model predictive speed control of the load with the gap closed: the quadratic law of ``lqi`` within the limit.

    ::

        U = arg min Σ (error/largest_error)² + … + (torque/largest_torque)²,   |U| ≤ torque_limit;  torque_motor = U₀

    The search starts at the unlimited optimum, clipped, and goes ``passes`` times over the moves, from the last to the
    first; each takes the best value within the limit with the others fixed (Gauss–Seidel). So it has a fixed number of
    steps, the cost falls with each, and every plan on the way keeps the limit. Each step is a saturation: the law is
    data like any other. Where the limit is not reached it is the quadratic law, up to the moves' lengths.

    Parameters
    ----------
    drivetrain, dt, largest_error, largest_torque, largest_oscillation, largest_twist : as in ``lqi``
    torque_limit : float, Nm
    moves, passes : int
        More are nearer to the optimum: moves·passes saturations in each step.

    Returns
    -------
    DiscreteSystem
        Inputs and output as those of ``lqi`` with ``load_torque``.

    Raises
    ------
    InvalidInput
        As ``lqi``; also for an infinite torque limit, and less than one move or pass.

    Notes
    -----
    Rawlings, Mayne & Diehl 2017, Model Predictive Control, sections 1.3 and 2.5 (horizon, terminal cost); the search:
    Luo & Tseng 1992, J. Optimization Theory and Applications 72, 7–35 (convergence of coordinate descent in a box).
    """
    for name, count in (("moves", moves), ("passes", passes)):
        if not (isinstance(count, int) and count >= 1):
            raise InvalidInput(f"predictive.{name}", repr(count), "a whole number from 1 on", "8 is usual.")
    if not (math.isfinite(torque_limit) and torque_limit > 0.0):
        raise InvalidInput(
            "predictive.torque_limit", repr(torque_limit), "a positive number in Nm", "Give it."
        )
    model = design_model(drivetrain, dt)
    rows = wished_rows("predictive", model, largest_error, largest_torque, largest_oscillation, largest_twist)
    horizon = round(HORIZON / (drivetrain.pole_frequency * dt))
    plan = closed_plan(model, rows, 1.0 / largest_torque**2, move_lengths(horizon, moves))
    return _law(drivetrain, model, plan, passes, torque_limit)


def _law(
    drivetrain: Drivetrain, model: DesignModel, plan: Plan, passes: int, torque_limit: float
) -> DiscreteSystem:
    """The search as curves, one behind the other."""
    inputs = (
        "speed_reference", "twist_elastic_estimated", "speed_motor_estimated", "speed_load_estimated",
        "friction_load_estimated", "torque_motor_acting", "torque_load_estimated",
    )  # fmt: skip
    actuator = actuator_state(drivetrain, model.dt, inputs)
    states = actuator.get("states", ())
    signals = (*states, *inputs, "friction_motor")
    state, steady = _from_steady(drivetrain, model, dict(zip(signals, np.eye(len(signals)), strict=True)))
    z, by_curves = _search(plan, state, steady, passes)
    z[0, signals.index("speed_reference")] = 1.0
    motor = drivetrain.frictions[0]
    n, count = len(states), len(z)
    return DiscreteSystem(
        **actuator, inputs=inputs, outputs=("torque_motor",), dt=model.dt, name="predictive",
        curves=(
            reference_direction(motor.coulomb_plus, motor.coulomb_minus),
            *[saturation(torque_limit)] * (count - 1),
        ),
        F=z[:, :n], G=z[:, n:-1], H=by_curves, J=np.eye(1, count, count - 1),
    )  # fmt: skip


def _search(plan: Plan, state: Array, steady: Array, passes: int) -> tuple[Array, Array]:
    """Arguments of all curves, by signals and by curves: the motor's friction, m moves to start with, m in each pass.

    ``state`` (n, signals) and ``steady`` (signals,) as ``_from_steady`` gives them; the last signal is the motor's
    friction, which is the first curve.
    """
    m = len(plan.lengths)
    linear = plan.state_gradient @ state - np.outer(plan.hessian @ np.ones(m), steady)
    start = np.outer(np.ones(m), steady) - np.linalg.solve(plan.hessian, plan.state_gradient @ state)
    count = 1 + m * (1 + passes)
    z, by_curves = np.zeros((count, steady.size)), np.zeros((count, count))
    z[1 : 1 + m] = start
    newest = np.arange(1, 1 + m)
    for row, move in zip(range(1 + m, count), list(range(m))[::-1] * passes, strict=True):
        others = np.arange(m) != move
        z[row] = -linear[move] / plan.hessian[move, move]
        by_curves[row, newest[others]] = -plan.hessian[move, others] / plan.hessian[move, move]
        newest[move] = row
    by_curves[1:, 0] += z[1:, -1]
    return z, by_curves


def _from_steady(drivetrain: Drivetrain, model: DesignModel, one: dict[str, Array]) -> tuple[Array, Array]:
    """Rows over the signals: the state (n, signals) as difference from the steady one, and the torque that holds it."""
    reference, load = one["speed_reference"], one["speed_load_estimated"]
    # The observer's friction has its viscous part at the present speed; the steady state has it at the set-point.
    shaft = (
        one["friction_load_estimated"]
        + drivetrain.viscous * (reference - load)
        - one["torque_load_estimated"]
    )
    torque = shaft + drivetrain.viscous_motor * reference + one["friction_motor"]
    now = {
        "twist": one["twist_elastic_estimated"], "speed_motor": one["speed_motor_estimated"], "speed_load": load,
        "torque_actuator": one.get("torque_actuator", 0.0 * torque), "torque_last": one["torque_motor_acting"],
    }  # fmt: skip
    held = {"twist": shaft / drivetrain.stiffness, "speed_motor": reference, "speed_load": reference}
    return np.array([now[name] - held.get(name, torque) for name in model.states]), torque

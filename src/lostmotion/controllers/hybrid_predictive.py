"""Hybrid model predictive speed control: the crossing of the gap is part of the plan, its end is enumerated."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import Limit, checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..kernels.predictive.layout import INSTANTS, MOVES, SIGNALS
from ..systems import Stepper
from .feedback.feedback_law import OSCILLATION_SHARE
from .feedback.reference_direction import REFERENCE_BAND
from .planning.crossing_plan import (
    CLOSING,
    FREE,
    SPEED_LOAD,
    CrossingProblem,
    cost_to_go,
    crossing_program,
    shaft_models,
)
from .planning.plan_cost import move_lengths
from .predictive import HORIZON

Array = NDArray[np.float64]

#: Most moves in the gap, and latest contact in shortest times for the gap from rest to rest (calibrated on the virtual
#: rigs 1 to 4).
GAP_MOVES, LATEST = 5, 1.5
#: Share of the backlash by which the gap may be narrower than known; samples by which the contact may come later
#: (calibrated likewise).
TOLERANCE, LATE = 0.03, 2
#: Soft torque against the motion in the gap, as a share of the torque limit: the rest is for model errors (calibrated
#: likewise).
BRAKING_SHARE = 0.6
#: Change of the torque from move to move that costs as much as the largest torque in one sample, as a share of it
#: (calibrated likewise).
CHANGE_SHARE = 0.3
#: Excess over a soft limit that costs as much as the largest error in one sample: of twist, speed, torque, as a share
#: of the limit (calibrated likewise).
TWIST_SHARE, SPEED_SHARE, TORQUE_SHARE = 0.05, 0.05, 0.01
#: Distance from the gap's edge that does, at the instant of contact, as a share of the backlash (calibrated likewise).
CONTACT_SHARE = 0.002


@checks_arguments
def hybrid_predictive(
    drivetrain: Drivetrain,
    *,
    dt: float,
    largest_error: float,
    largest_torque: float,
    torque_limit: float,
    contact_speed: float,
    largest_oscillation: Limit | None = None,
    twist_limit: Limit = math.inf,
    torque_soft: Limit = math.inf,
    braking_torque: float | None = None,
    tolerance: float = TOLERANCE,
) -> Stepper:
    """Model predictive speed control of the load across the gap: in each sample the best of many plans.

    ::

        min over N, U:  Σ (error/largest_error)² + (torque/largest_torque)² + (oscillation/largest_oscillation)² + …
        motor and load apart until sample N, at the edge then; joined by the shaft from there on;  |U| ≤ torque_limit

    For given N, and side of the gap, this is a small quadratic program of ``MOVES`` moves, made here. In the step they
    are solved in the order of their least possible costs until none can be better. Soft limits: impact speed, elastic
    twist between 0 (a shaft does not pull) and ``twist_limit``, torque. While the shaft is wound one candidate stays
    closed; the others cross to the other side.

    The search is warm: each candidate goes on from its plan of the sample before. It has a cap of steps
    (``kernels.predictive.hybrid``), and every plan on the way keeps the torque limit: when the cap is reached the best
    plan so far is used. The winner of the sample before comes first.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses with backlash.
    dt, largest_error, largest_torque, largest_oscillation : as in ``lqi``
        The oscillation counts with the gap closed.
    torque_limit : float, Nm
        Never exceeded.
    contact_speed : float, rad/s
        Soft limit of the speed at which the gap closes.
    twist_limit : float, rad
        Soft limit of the elastic twist; default inf: none.
    torque_soft : float, Nm
        Soft limit of the motor torque; default inf: none.
    braking_torque : float, Nm
        Soft limit of the torque against the motion in the gap; default ``BRAKING_SHARE``·torque_limit.
    tolerance : float
        Share of the backlash by which the gap may be narrower than known: so much earlier ``contact_speed`` is reached.

    Returns
    -------
    Stepper
        Inputs speed_reference, twist_estimated, twist_elastic_estimated, speed_motor_estimated, speed_load_estimated,
        friction_load_estimated, torque_motor_acting (see ``lqi``), torque_load_estimated; output torque_motor.

    Raises
    ------
    InvalidInput
        If there are not two masses with backlash, or a number is not positive.

    Notes
    -----
    Bemporad & Morari 1999, Automatica 35, 407–427 (the mixed-integer program that the enumeration solves); Lagerberg &
    Egardt 2005, 44th IEEE CDC, 3842–3847 (predictive control across backlash).
    """
    if largest_oscillation is None:
        largest_oscillation = OSCILLATION_SHARE * largest_error
    wishes = {
        "largest_error": largest_error, "largest_torque": largest_torque, "contact_speed": contact_speed,
        "torque_limit": torque_limit, "twist_limit": twist_limit, "torque_soft": torque_soft,
        "largest_oscillation": largest_oscillation,
        "braking_torque": BRAKING_SHARE * torque_limit if braking_torque is None else braking_torque,
    }  # fmt: skip
    _check(drivetrain, tolerance, wishes)
    problem = crossing_problem(drivetrain, dt, wishes, tolerance)
    programs = [
        crossing_program(problem, *moves).numbers() for moves in candidate_moves(drivetrain, dt, wishes)
    ]
    return Stepper(
        name="hybrid_predictive", dt=dt, estimator="hybrid_predictive", outputs=("torque_motor",), exportable=True,
        inputs=(
            "speed_reference", "twist_estimated", "twist_elastic_estimated", "speed_motor_estimated",
            "speed_load_estimated", "friction_load_estimated", "torque_motor_acting", "torque_load_estimated",
        ),
        parameters=np.concatenate([_law_numbers(drivetrain, dt, wishes), *programs]),
    )  # fmt: skip


def crossing_problem(
    drivetrain: Drivetrain, dt: float, wishes: dict[str, float], tolerance: float
) -> CrossingProblem:
    """What all candidates share; ``wishes`` are the arguments of ``hybrid_predictive`` of these names."""
    gap, closed = shaft_models(drivetrain, dt)
    error = np.eye(SIGNALS)[SPEED_LOAD] / wishes["largest_error"]
    oscillation = CLOSING / wishes["largest_oscillation"]
    weight, limit, speed = wishes["largest_torque"] ** -2, wishes["torque_limit"], wishes["contact_speed"]
    return CrossingProblem(
        gap=gap, closed=closed, error=error, oscillation=oscillation,
        torque_weight=weight, change_weight=(CHANGE_SHARE * wishes["largest_torque"]) ** -2,
        last=cost_to_go(closed, np.array([error, oscillation]), weight, drivetrain),
        contact_speed=speed, early=round(tolerance * drivetrain.backlash / (speed * dt)), late=LATE,
        twist_limit=min(wishes["twist_limit"], FREE), torque_soft=min(wishes["torque_soft"], FREE),
        braking_torque=wishes["braking_torque"],
        contact_unit=CONTACT_SHARE * drivetrain.backlash, twist_unit=TWIST_SHARE * min(wishes["twist_limit"], FREE),
        speed_unit=SPEED_SHARE * speed, torque_unit=TORQUE_SHARE * limit,
    )  # fmt: skip


def candidate_moves(
    drivetrain: Drivetrain, dt: float, wishes: dict[str, float]
) -> list[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Lengths (samples) of the moves in the gap and after it: without a gap, then for each instant of contact."""
    horizon = round(HORIZON / (drivetrain.pole_frequency * dt))
    torque = min(wishes["torque_limit"], wishes["torque_soft"])
    turn = drivetrain.inertia_motor * (1.0 / torque + 1.0 / min(torque, wishes["braking_torque"]))
    shortest = math.sqrt(2.0 * drivetrain.backlash * turn)
    longest = math.ceil((LATEST * shortest + 2.0 * drivetrain.lag + dt) / dt)
    found: list[tuple[tuple[int, ...], tuple[int, ...]]] = [((), _after(horizon, MOVES))]
    contact = 0
    for wished in np.geomspace(1.0, max(longest, 1), INSTANTS):
        contact = max(round(wished), contact + 1)
        ends = np.round(np.linspace(0.0, contact, min(contact, GAP_MOVES) + 1)).astype(int)
        in_gap = tuple(int(length) for length in np.diff(ends))
        found.append((in_gap, _after(horizon, MOVES - len(in_gap))))
    return found


def _after(horizon: int, count: int) -> tuple[int, ...]:
    """Lengths of exactly so many moves: a short horizon grows by single samples."""
    lengths = move_lengths(horizon, count)
    return lengths + (1,) * (count - len(lengths))


def _law_numbers(drivetrain: Drivetrain, dt: float, wishes: dict[str, float]) -> Array:
    """The numbers in front of the programs, in the order of ``kernels.predictive.layout``."""
    motor = drivetrain.frictions[0]
    return np.array([
        wishes["torque_limit"], math.exp(-dt / drivetrain.lag) if drivetrain.lag > 0.0 else 0.0,
        0.5 * drivetrain.backlash, drivetrain.viscous, drivetrain.viscous_motor, motor.coulomb_plus,
        motor.coulomb_minus, REFERENCE_BAND,
    ])  # fmt: skip


def _check(drivetrain: Drivetrain, tolerance: float, wishes: dict[str, float]) -> None:
    if not drivetrain.backlash > 0.0:
        raise InvalidInput(
            "hybrid_predictive: backlash", repr(drivetrain.backlash), "a positive angle in rad",
            "Without a gap take predictive.",
        )  # fmt: skip
    for name, value in wishes.items():
        endless = name in ("twist_limit", "torque_soft", "largest_oscillation")
        if not (value > 0.0 and (endless or math.isfinite(value))):
            raise InvalidInput(
                f"hybrid_predictive.{name}", repr(value), "a positive number in SI units", "Check the unit."
            )
    if not 0.0 <= tolerance <= 1.0:
        raise InvalidInput("hybrid_predictive.tolerance", repr(tolerance), "0 to 1", "Take the default.")

"""H∞ speed control of the load by state feedback: the worst case of the unknown torques decides."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DesignModel, DiscreteSystem, design_model
from .feedback.feedback_law import QuadraticFeedback, feedback_law, wished_rows, with_steady_state

Array = NDArray[np.float64]

#: Attenuation level as a multiple of the smallest possible one (calibrated on the virtual rigs 1 to 3: nearer to 1 the
#: gains grow and nothing else improves).
MARGIN = 1.5
#: Nearer to the smallest level the Riccati equation loses the digits that its gain needs (numerics).
LEAST_MARGIN = 1.005
#: Relative accuracy of the search for the smallest level, and its ends (numerics).
TOLERANCE, LOWEST, HIGHEST = 1e-5, 1e-9, 1e9
#: Smallest eigenvalue, relative to the largest, that counts as not negative (numerics).
SEMIDEFINITE = -1e-9


@dataclass(frozen=True, eq=False)
class RobustFeedback:
    """The feedback of one attenuation level ``level``, and the smallest level there is (both without unit)."""

    feedback: QuadraticFeedback
    level: float
    smallest_level: float


@checks_arguments
def robust_feedback(
    drivetrain: Drivetrain,
    dt: float,
    *,
    largest_error: float,
    largest_torque: float,
    load_torque: float,
    largest_oscillation: float | None = None,
    largest_twist: float = math.inf,
    margin: float = MARGIN,
) -> RobustFeedback:
    """Gains of ``h_infinity``, with the level that they reach."""
    model = design_model(drivetrain, dt)
    rows = wished_rows("h_infinity", model, largest_error, largest_torque, largest_oscillation, largest_twist)
    for name, value, least in (("load_torque", load_torque, 0.0), ("margin", margin, LEAST_MARGIN)):
        if not (math.isfinite(value) and value > least):
            raise InvalidInput(f"h_infinity.{name}", repr(value), f"a number above {least:g}", "Check it.")
    scaled = _Scaled(model, rows, 1.0 / largest_torque**2, load_torque)
    smallest = _smallest_level(scaled)
    gain = scaled.gain(margin * smallest)
    if gain is None:
        raise InvalidInput("h_infinity.margin", repr(margin), "a level with a gain", "Raise the margin.")
    return RobustFeedback(with_steady_state(drivetrain, model, gain), margin * smallest, smallest)


@dataclass(frozen=True, eq=False)
class _Scaled:
    """x⁺ = A x + B u + E w with wishes as rows: Σ |rows·x|² + r·u² is held below level² · Σ w²; w in its own unit."""

    model: DesignModel
    rows: Array
    r: float
    load_torque: float

    def gain(self, level: float) -> Array | None:
        """The gain (n,) that reaches the level, None where there is none."""
        from scipy.linalg import solve_discrete_are

        a, b, e = self.model.A, self.model.B[:, None], self.load_torque * self.model.E[:, None]
        both, weight = np.hstack([b, e]), np.diag([self.r, -(level**2)])
        try:
            p = solve_discrete_are(a, both, self.rows.T @ self.rows, weight)
        except (np.linalg.LinAlgError, ValueError):
            return None
        # The law does not know the torque of its own sample: the worst one must be bounded for every torque of the law.
        rest = level**2 - float((e.T @ p @ e)[0, 0])
        values = np.linalg.eigvalsh(0.5 * (p + p.T))
        if rest <= 0.0 or values[0] < SEMIDEFINITE * values[-1]:
            return None
        gains = np.linalg.solve(weight + both.T @ p @ both, both.T @ p @ a)
        gain = np.asarray(gains[0])
        return gain if np.max(np.abs(np.linalg.eigvals(a - b @ gain[None, :]))) < 1.0 else None


def _smallest_level(scaled: _Scaled) -> float:
    """By bisection of its logarithm."""
    low, high = LOWEST, HIGHEST
    if scaled.gain(high) is None:
        raise InvalidInput(
            "h_infinity",
            "no gain at any level",
            "weights and a torque that a loop can reach",
            "Check the units.",
        )
    while high / low > 1.0 + TOLERANCE:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if scaled.gain(middle) is None else (low, middle)
    return high


@checks_arguments
def h_infinity(
    drivetrain: Drivetrain,
    *,
    dt: float,
    largest_error: float,
    largest_torque: float,
    load_torque: float,
    largest_oscillation: float | None = None,
    largest_twist: float = math.inf,
    margin: float = MARGIN,
    torque_limit: float = math.inf,
) -> DiscreteSystem:
    """H∞ speed control of the load; the form and the signals are those of ``lqi``, only the gain differs.

    ::

        Σ (error/largest_error)² + (oscillation/largest_oscillation)²
            + (twist/largest_twist)² + (torque/largest_torque)²
            <  level² · Σ (torque on the load/load_torque)²        for every torque on the load of finite energy

        P = Q + Aᵀ P (I + (B r⁻¹ Bᵀ − level⁻² E Eᵀ) P)⁻¹ A

    with level = ``margin`` times the smallest for which there is such a gain. All in units of the wishes, so the
    Riccati equation is well scaled.

    Parameters
    ----------
    drivetrain, dt, largest_error, largest_torque, largest_oscillation, largest_twist, torque_limit : as in ``lqi``
    load_torque : float, Nm
        Torque on the load that deserves the wishes: a wrong load inertia shows as such a torque.
    margin : float
        Above ``LEAST_MARGIN``; ∞ would give the gain of ``lqi``.

    Returns
    -------
    DiscreteSystem
        As ``lqi`` with ``load_torque``.

    Raises
    ------
    InvalidInput
        If there are not two masses, a number is not positive, or the margin too small.

    Notes
    -----
    Başar & Bernhard 1995, H∞-Optimal Control and Related Minimax Design Problems, section 3.2 (full information; the
    states come from an observer).
    """
    found = robust_feedback(
        drivetrain, dt, largest_error=largest_error, largest_torque=largest_torque, load_torque=load_torque,
        largest_oscillation=largest_oscillation, largest_twist=largest_twist, margin=margin,
    )  # fmt: skip
    return feedback_law(
        "h_infinity", drivetrain, found.feedback, dt=dt, torque_limit=torque_limit, load_torque=True
    )

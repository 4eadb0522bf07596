"""Laws in continuous time, for proofs and for comparison with the literature: what the sampled laws approximate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...controllers.pole_placement import DEFAULT_POLES, state_feedback
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...observers import kalman_gain
from ...observers.model import ObserverModel, observer_model
from ..static_curves import StaticCurve

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class ContinuousLaw:
    """A law in Lur'e form in continuous time; curves may jump.

    ::

        z  = F x            wᵢ = curveᵢ(zᵢ)
        ẋ  = A x + B u + E w
        torque_motor = C x + D u + J w

    Parameters
    ----------
    inputs : tuple of str
        speed_reference, and what the law reads of the plant: speeds, twist, shaft torque.
    states : tuple of str
    curves : tuple of StaticCurve
    A, B, E, F, C, D, J : arrays
        Shapes follow from the equations.
    """

    inputs: tuple[str, ...]
    states: tuple[str, ...]
    curves: tuple[StaticCurve, ...]
    A: Array
    B: Array
    E: Array
    F: Array
    C: Array
    D: Array
    J: Array

    def to_dict(self) -> dict[str, Any]:
        """Plain data, in the form of ``DiscreteSystem``; the sample time 0 says that A, B and E give rates."""
        count = len(self.curves)
        curves = [
            {
                "points": [[float(z), float(w)] for z, w in curve.points],
                "slope_left": float(curve.left),
                "slope_right": float(curve.right),
            }
            for curve in self.curves
        ]
        matrices = {key: getattr(self, key).tolist() for key in ("A", "B", "E", "F", "C", "D", "J")}
        matrices |= {
            "G": np.zeros((count, len(self.inputs))).tolist(),
            "H": np.zeros((count, count)).tolist(),
        }
        return {
            "dt": 0.0, "inputs": list(self.inputs), "outputs": ["torque_motor"], "states": list(self.states),
            "curves": curves, **matrices,
        }  # fmt: skip


@checks_arguments
def continuous_pi(kp: float = 10.0, ki: float = 200.0) -> ContinuousLaw:
    """PI control of the motor speed, without a limit; defaults as those of ``controllers.pi``."""
    return ContinuousLaw(
        inputs=("speed_reference", "speed_motor"), states=("torque_integral",), curves=(), A=np.zeros((1, 1)),
        B=np.array([[ki, -ki]]), E=np.zeros((1, 0)), F=np.zeros((0, 1)), C=np.ones((1, 1)),
        D=np.array([[kp, -kp]]), J=np.zeros((1, 0)),
    )  # fmt: skip


@checks_arguments
def continuous_state_feedback(
    drivetrain: Drivetrain, poles: Sequence[complex] = DEFAULT_POLES
) -> ContinuousLaw:
    """Feedback of the measured twist and speeds, without an observer (Fietzek & Rinderknecht, section V)."""
    design = state_feedback(drivetrain, poles)
    return ContinuousLaw(
        inputs=("speed_reference", "twist", "speed_motor", "speed_load"), states=(), curves=(), A=np.zeros((0, 0)),
        B=np.zeros((0, 4)), E=np.zeros((0, 0)), F=np.zeros((0, 0)), C=np.zeros((1, 0)),
        D=np.array([[design.prefilter, *-design.gain]]), J=np.zeros((1, 0)),
    )  # fmt: skip


@checks_arguments
def continuous_observer_feedback(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    poles: Sequence[complex] = DEFAULT_POLES,
    compensation: bool = True,
) -> ContinuousLaw:
    """Kalman observer with gap and Coulomb friction, and feedback of its elastic twist and speeds.

    Fietzek & Rinderknecht, sections III and V. ``compensation``: of the load's friction, by its estimate.

    Raises
    ------
    InvalidInput
        For sensors from which the state is not observable, a lag, and friction of the motor: there is only the sampled
        law then.
    """
    motor = drivetrain.frictions[0]
    if drivetrain.lag or any(motor.level_at_rest):
        raise InvalidInput(
            "drivetrain", f"lag {drivetrain.lag:g} s, friction of the motor {motor.level_at_rest} Nm",
            "no lag and no Coulomb friction of the motor", "Prove the sampled law.",
        )  # fmt: skip
    model, design = observer_model(drivetrain, measured), state_feedback(drivetrain, poles)
    gain = kalman_gain(drivetrain, measured)
    c = np.array([model.measurement_row(signal) for signal in measured])
    curves = _curves(model, design.gain[0], design.friction_gain if compensation else 0.0)
    if drivetrain.shaft.has_backlash and "torque_shaft" in measured:
        # The expected torque is stiffness times what the gap leaves.
        by_torque = gain[:, list(measured).index("torque_shaft")] * drivetrain.stiffness
        curves[0] = curves[0]._replace(rates=curves[0].rates + by_torque)
    n, count = len(model.states), len(curves)
    by_curve = np.array([curve.rates for curve in curves]).reshape(count, n).T
    torque = {
        "C": -design.gain[np.newaxis],
        "D": np.array([[design.prefilter, *[0.0] * len(measured)]]),
        "J": np.array([[curve.torque for curve in curves]]),
    }
    return ContinuousLaw(
        inputs=("speed_reference", *measured), states=model.states,
        curves=tuple(curve.curve for curve in curves), F=np.array([c.argument for c in curves]).reshape(count, n),
        A=model.A - gain @ c + model.B @ torque["C"],
        B=np.hstack([np.zeros((n, 1)), gain]) + model.B @ torque["D"],
        E=by_curve + model.B @ torque["J"], **torque,
    )  # fmt: skip


class _LawCurve(NamedTuple):
    """A curve of the observer, the row of its argument, its effect on the states' rates and on the torque."""

    curve: StaticCurve
    argument: Array
    rates: Array
    torque: float


def _curves(model: ObserverModel, twist_gain: float, friction_gain: float) -> list[_LawCurve]:
    """Gap, the gap of the elastic twist, and friction of the load."""
    shaft, load, found = model.drivetrain.shaft, model.drivetrain.frictions[1], []
    if shaft.has_backlash:
        half = Fraction(shaft.backlash) / 2
        gap = StaticCurve(((-half, -half), (half, half)))
        # The feedback reads twist − gap(twist): nothing inside the gap.
        found.append(_LawCurve(gap, model.contact_argument(), model.E_gap[:, 0], 0.0))
        found.append(_LawCurve(gap, model.row(twist=1.0), 0.0 * model.E_gap[:, 0], twist_gain))
    plus, minus = Fraction(load.coulomb_plus), Fraction(load.coulomb_minus)
    if plus or minus:
        jump = StaticCurve(((Fraction(0), -minus), (Fraction(0), plus)))
        found.append(_LawCurve(jump, model.row(speed_load=1.0), model.E_load[:, 0], friction_gain))
    return found

"""Linear-quadratic speed control of the load, with the estimated load torque fed back."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import Limit, checks_arguments
from ..curves import saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem, design_model
from .reference_direction import reference_direction

Array = NDArray[np.float64]

#: Largest motor oscillation by default, in multiples of the largest error (calibrated on the virtual rigs 1 to 5).
OSCILLATION_SHARE = 2.0


@dataclass(frozen=True, eq=False)
class QuadraticFeedback:
    """torque = −gain·x + prefilter·speed_reference + load_gain·T_load + motor_gain·T_motor, with T_load = Coulomb
    friction of the load − torque_load and T_motor = Coulomb friction of the motor.

    ``gain`` is (n,) over ``states``, those of ``systems.design_model``; ``prefilter`` in Nm s/rad, ``load_gain`` and
    ``motor_gain`` without unit: with them none of the three leaves a steady error.
    """

    states: tuple[str, ...]
    gain: Array
    prefilter: float
    load_gain: float
    motor_gain: float


@checks_arguments
def quadratic_feedback(
    drivetrain: Drivetrain,
    dt: float,
    *,
    largest_error: float,
    largest_torque: float,
    largest_oscillation: Limit | None = None,
    largest_twist: float = math.inf,
) -> QuadraticFeedback:
    """Gains that minimise Σ (error/largest_error)² + (torque/largest_torque)² + … with the gap closed.

    The weights are Bryson's rule: each quantity counts by the value that it may have. See ``lqi``.
    """
    if largest_oscillation is None:
        largest_oscillation = OSCILLATION_SHARE * largest_error
    wishes = {
        "largest_error": largest_error, "largest_torque": largest_torque,
        "largest_oscillation": largest_oscillation, "largest_twist": largest_twist,
    }  # fmt: skip
    for name, value in wishes.items():
        finite = math.isfinite(value) or name in ("largest_oscillation", "largest_twist")
        if not (value > 0.0 and finite):
            raise InvalidInput(f"lqi.{name}", repr(value), "a positive number in SI units", "Check the unit.")
    model = design_model(drivetrain, dt)
    rows = np.array([
        model.row(speed_load=1.0) / largest_error,
        model.row(speed_motor=1.0, speed_load=-1.0) / largest_oscillation,
        model.row(twist=1.0) / largest_twist,
    ])  # fmt: skip
    gain = _riccati(model.A, model.B[:, None], rows.T @ rows, 1.0 / largest_torque**2)
    # What holds a steady state: a torque at the motor shows in the actuator's states, one at the load in the twist too.
    torques = model.row(**{name: 1.0 for name in model.states if name.startswith("torque_")})
    motor_gain = 1.0 + float(gain @ torques)
    load_gain = motor_gain + float(gain[0]) / drivetrain.stiffness
    speeds = float(gain @ model.row(speed_motor=1.0, speed_load=1.0))
    prefilter = speeds + motor_gain * drivetrain.viscous_motor + load_gain * drivetrain.viscous
    return QuadraticFeedback(model.states, gain, prefilter, load_gain, motor_gain)


def _riccati(A: Array, B: Array, Q: Array, r: float) -> Array:
    from scipy.linalg import solve_discrete_are

    p = solve_discrete_are(A, B, Q, np.array([[r]]))
    return np.asarray((B.T @ p @ A)[0] / (r + float((B.T @ p @ B)[0, 0])))


@checks_arguments
def lqi(
    drivetrain: Drivetrain,
    *,
    dt: float,
    largest_error: float,
    largest_torque: float,
    largest_oscillation: Limit | None = None,
    largest_twist: float = math.inf,
    torque_limit: float = math.inf,
    load_torque: bool = True,
) -> DiscreteSystem:
    """Linear-quadratic speed control of the load; with an observer that estimates the load torque, LQG with
    integral action.

    ::

        torque_motor = clip(−gain·(x − x_steady) + torque_steady, ±torque_limit)
        x = (twist_elastic, speed_motor, speed_load, torque_actuator, torque_motor_acting)

    x_steady and torque_steady hold the set-point against the estimated friction and load torque. The integral action is
    the observer's: its load torque goes on changing until the speed is right. An observer that reads the torque that
    **acts** cannot wind up, whatever limited it; so both this law and the observer read ``torque_motor_acting``:
    the drive's report, or ``one_sample_delay("torque_motor", dt, "torque_motor_acting")``.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
        Sample time; the design counts with one sample of computing delay.
    largest_error : float, rad/s
        Speed error of the load that deserves the largest torque.
    largest_torque : float, Nm
        Beyond that of the steady state.
    largest_oscillation : float, rad/s
        Of motor speed − load speed; default ``OSCILLATION_SHARE``·largest_error. inf: no weight, and the law chatters
        in the gap.
    largest_twist : float, rad
        Elastic twist; default inf: no weight.
    torque_limit : float, Nm
        inf: no limit.
    load_torque : bool
        Whether to feed back an estimated load torque. Without it a load torque leaves a steady error.

    Returns
    -------
    DiscreteSystem
        Inputs speed_reference, twist_elastic_estimated, speed_motor_estimated, speed_load_estimated,
        friction_load_estimated, torque_motor_acting, and torque_load_estimated with ``load_torque``; output
        torque_motor; state torque_actuator, where the drivetrain has a lag.

    Raises
    ------
    InvalidInput
        If there are not two masses, or a number is not positive.

    Notes
    -----
    Bryson & Ho 1975, Applied Optimal Control, section 5.2 (weights); Franklin, Powell & Workman 1998, Digital Control
    of Dynamic Systems, section 8.5 (disturbance estimate as integral action).
    """
    if not torque_limit > 0.0:
        raise InvalidInput(
            "lqi.torque_limit", repr(torque_limit), "a positive number in Nm", "Use inf for none."
        )
    design = quadratic_feedback(
        drivetrain, dt, largest_error=largest_error, largest_torque=largest_torque,
        largest_oscillation=largest_oscillation, largest_twist=largest_twist,
    )  # fmt: skip
    k = dict(zip(design.states, design.gain, strict=True))
    terms = {
        "speed_reference": design.prefilter,
        "twist_elastic_estimated": -k["twist"],
        "speed_motor_estimated": -k["speed_motor"],
        # The prefilter carries the viscous part, so the friction's estimate gives its Coulomb part alone.
        "speed_load_estimated": -k["speed_load"] - design.load_gain * drivetrain.viscous,
        "friction_load_estimated": design.load_gain,
        "torque_motor_acting": -k["torque_last"],
    }
    if load_torque:
        terms["torque_load_estimated"] = -design.load_gain
    inputs, direct = tuple(terms), np.array([list(terms.values())])
    motor = drivetrain.frictions[0]
    levels = design.motor_gain * motor.coulomb_plus, design.motor_gain * motor.coulomb_minus
    curves = [reference_direction(*levels)] if max(levels) > 0.0 else []
    n, by_state = len(curves), np.zeros((1, 0))
    state: dict[str, Any] = {}
    if drivetrain.lag > 0.0:
        # The current loop's torque, from the torque that acts.
        decay = math.exp(-dt / drivetrain.lag)
        by_state = np.array([[-k["torque_actuator"]]])
        state = {
            "states": ("torque_actuator",), "A": np.array([[decay]]),
            "B": (1.0 - decay) * np.array([[float(name == "torque_motor_acting") for name in inputs]]),
        }  # fmt: skip
    by_reference = np.eye(1, len(inputs))[:n]
    names: dict[str, Any] = {"inputs": inputs, "outputs": ("torque_motor",), "dt": dt, "name": "lqi", **state}
    if math.isinf(torque_limit):
        return DiscreteSystem(
            **names, curves=tuple(curves), G=by_reference, C=by_state, D=direct, J=np.ones((1, n))
        )
    return DiscreteSystem(
        **names,
        curves=(*curves, saturation(torque_limit)),
        F=np.vstack([np.zeros((n, by_state.shape[1])), by_state]),
        G=np.vstack([by_reference, direct]),
        H=np.eye(n + 1, k=-1),
        J=np.eye(1, n + 1, n),
    )

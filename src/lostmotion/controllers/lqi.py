"""Linear-quadratic speed control of the load, with the estimated load torque fed back."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import Limit, checks_arguments
from ..drivetrain import Drivetrain
from ..systems import DiscreteSystem, design_model
from .feedback.feedback_law import QuadraticFeedback, feedback_law, wished_rows, with_steady_state

Array = NDArray[np.float64]


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
    model = design_model(drivetrain, dt)
    rows = wished_rows("lqi", model, largest_error, largest_torque, largest_oscillation, largest_twist)
    gain = _riccati(model.A, model.B[:, None], rows.T @ rows, 1.0 / largest_torque**2)
    return with_steady_state(drivetrain, model, gain)


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
    design = quadratic_feedback(
        drivetrain, dt, largest_error=largest_error, largest_torque=largest_torque,
        largest_oscillation=largest_oscillation, largest_twist=largest_twist,
    )  # fmt: skip
    return feedback_law("lqi", drivetrain, design, dt=dt, torque_limit=torque_limit, load_torque=load_torque)
